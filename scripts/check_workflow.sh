#!/usr/bin/env bash
# Tries the Snakemake workflow on small phantoms: on this machine, and with a stand-in for Slurm's sbatch. Needs Debian's
# package `snakemake`, whose many dependencies are the reason why scripts/setup.sh does not install it.
#   scripts/check_workflow.sh [pellicle]
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
program=$(readlink -f "${1:-build/release/cli/pellicle}")
command -v snakemake >/dev/null || { echo "snakemake is missing: apt-get install snakemake" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export HOME=$folder # Snakemake keeps a cache there

echo "name,input,seed-sphere" >cases.csv
for i in 1 2 3 4; do
  "$program" phantom -o . --name "ball$i" --shape sphere --radius 5 --size 20,20,20 --snr 10 --seed "$i" >/dev/null
  echo "case$i,ball$i.nii.gz,\"0,0,0,3\"" >>cases.csv
done
echo "lost,nothing.nii.gz," >>cases.csv

# sbatch as the profile calls it: runs the script at once and tells a number; sacct knows how it ended.
mkdir bin
cat >bin/sbatch <<'END'
#!/usr/bin/env bash
number=$(date +%s%N)
code=0
bash "${@: -1}" >/dev/null 2>&1 || code=$?
[ "$code" = 0 ] && echo COMPLETED >"$HOME/job-$number" || echo FAILED >"$HOME/job-$number"
echo "$*" >>"$HOME/sbatch.log"
echo "$number"
END
printf '#!/usr/bin/env bash\ncat "$HOME/job-$2"\n' >bin/sacct
chmod +x bin/*
PATH=$folder/bin:$PATH

for profile in local slurm; do
  snakemake --quiet --snakefile "$root/workflow/Snakefile" --profile "$root/workflow/profiles/$profile" --latency-wait 2 \
    --config output="$profile" shards=3 pellicle="$program" flags="--detail 0 --write mask,model,report" threads=1 >log 2>&1 || { cat log; exit 1; }
  [ "$(cut -f1,2 "$profile/batch.tsv" | grep -c -P '\t(ok|ambiguous|doubtful)$')" = 4 ]
  grep -q -P '^lost\tfailed\t66\t' "$profile/batch.tsv"
  [ -s "$profile/report.html" ]
done
[ "$(grep -c 'job-name=pellicle-part' sbatch.log)" = 3 ]
for i in 1 2 3 4; do cmp "local/case$i/case${i}_mask.nii.gz" "slurm/case$i/case${i}_mask.nii.gz"; done
echo "the workflow works on one machine and by parts; both give the same masks"

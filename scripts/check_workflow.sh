#!/usr/bin/env bash
# Tests the Snakemake workflow on small phantoms, on this machine and through Slurm, and the job script of docs/cluster.md.
# Needs Debian's package `snakemake`; scripts/setup.sh does not install it, because it has many dependencies. With Debian's
# `slurm-wlm` it starts a Slurm with one node for the test; without it, a small script takes the place of sbatch.
#   scripts/check_workflow.sh [pellicle]
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
program=$(readlink -f "${1:-build/release/cli/pellicle}")
command -v snakemake >/dev/null || { echo "snakemake is missing: apt-get install snakemake" >&2; exit 1; }
. scripts/one_node_slurm.sh
folder=$(mktemp -d)
trap 'one_node_slurm_stop; rm -rf "$folder"' EXIT
cd "$folder"
export HOME=$folder # Snakemake keeps a cache there
mkdir bin
ln -s "$program" bin/pellicle
PATH=$folder/bin:$PATH
flags="--detail 0 --write mask,model,report"

# 27 phantoms and 3 broken volumes.
echo "name,input,seed-sphere" >cases.csv
for i in $(seq 1 30); do
  if [ $((i % 10)) = 5 ]; then
    echo "no volume" >"ball$i.nii.gz"
  else
    pellicle phantom -o . --name "ball$i" --shape sphere --radius 5 --size 20,20,20 --snr 10 --seed "$i" >/dev/null
  fi
  echo "case$i,ball$i.nii.gz,\"0,0,0,3\"" >>cases.csv
done
code=0
pellicle batch cases.csv -o undisturbed --keep-going --no-progress $flags >/dev/null 2>&1 || code=$?
[ "$code" = 1 ]

# Fails unless the masks, the models and the table of a folder are the same as those of the undisturbed run.
same() {
  local file
  for file in undisturbed/case*/*_mask.nii.gz undisturbed/case*/*_model.json; do cmp "$file" "$1/${file#*/}"; done
  [ "$(find "$1" -name '*_mask.nii.gz' | wc -l)" = 27 ]
  [ "$(grep -c -P '\tfailed\t65\t' "$1/batch.tsv")" = 3 ]
  diff <(cut -f1,2,3,5,6 undisturbed/batch.tsv) <(cut -f1,2,3,5,6 "$1/batch.tsv")
}

missing=$(one_node_slurm_missing)
if [ -z "$missing" ]; then
  one_node_slurm_start "$folder/slurm"
  slurm="a real Slurm ($(sinfo --version))"
  [ "$("$root/workflow/profiles/slurm/slurm_status.sh" 12345)" = failed ] # no such job
else
  # This sbatch runs the script at once and prints a job number; this sacct prints how the job ended.
  slurm="a STAND-IN for Slurm, as $missing is missing (apt-get install slurm-wlm)"
  cat >bin/sbatch <<'SBATCH'
#!/usr/bin/env bash
number=$(date +%s%N)
code=0
bash "${@: -1}" >/dev/null 2>&1 || code=$?
[ "$code" = 0 ] && echo COMPLETED >"$HOME/job-$number" || echo FAILED >"$HOME/job-$number"
echo "$number"
SBATCH
  printf '#!/usr/bin/env bash\ncat "$HOME/job-$2"\n' >bin/sacct
  printf '#!/usr/bin/env bash\nexit 1\n' >bin/scontrol
  chmod +x bin/sbatch bin/sacct bin/scontrol
fi

for profile in local slurm; do
  snakemake --quiet --snakefile "$root/workflow/Snakefile" --profile "$root/workflow/profiles/$profile" --latency-wait 2 \
    --config output="$profile" shards=3 pellicle="$program" flags="$flags" threads=1 mem_mb=500 >log 2>&1 || { cat log; exit 1; }
  same "$profile"
  [ -s "$profile/report.html" ]
done
[ "$(grep -c "Submitted job" log)" -ge 3 ] # the parts went through sbatch

if [ -n "$missing" ]; then
  echo "the workflow works on one machine and by parts with the same masks as an undisturbed batch; tried with $slurm"
  exit 0
fi

# The job script as shown in docs/cluster.md, with the flags of the cases. It is killed once there are masks, then submitted again.
awk '/^```/ { inside = !inside; if (!inside && text ~ /#SBATCH --array/) { printf "%s", text; exit } text = ""; next } inside { text = text $0 "\n" }' \
  "$root/docs/cluster.md" | sed "s|--resume\$|--resume $flags|" >cases.sbatch
grep -q -- "--resume $flags" cases.sbatch
array=$(sbatch --parsable cases.sbatch)
for i in $(seq 1 300); do [ "$(find out -name '*_mask.nii.gz' 2>/dev/null | wc -l)" -ge 3 ] && break; sleep 0.05; done
scancel --full --signal=KILL "$array"
scancel "$array"
while [ -n "$(squeue --noheader)" ]; do sleep 0.2; done
killed=$(find out -name '*_mask.nii.gz' | wc -l)
[ "$killed" -ge 3 ] && [ "$killed" -lt 27 ]
array=$(sbatch --parsable cases.sbatch)
code=0
sbatch --wait --dependency="afterany:$array" --wrap "pellicle batch cases.csv -o out --keep-going --resume $flags" >/dev/null || code=$?
[ "$code" = 1 ] # three cases failed
same out
echo "the workflow works on one machine and by parts, and so does the array job of docs/cluster.md, killed after $killed of 27 masks and" \
  "submitted again: the same masks, models and tables as an undisturbed batch; tried with $slurm"

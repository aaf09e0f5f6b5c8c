#!/usr/bin/env bash
# The main task on real data: segments the brain in a T1 head MRI, fully automatically. Results are in demo-out/.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh release pellicle
program=build/release/cli/pellicle
head=/usr/share/mricron/templates/ch2.nii.gz
bet=/usr/share/mricron/templates/ch2bet.nii.gz

"$program" info "$head"
"$program" segment -i "$head" -o demo-out --preset brain-t1 --write mask,mesh,model,report,qc --overwrite
echo
echo "Agreement with FSL BET (ch2bet), not accuracy:"
"$program" evaluate "$bet" demo-out/ch2_mask.nii.gz
echo
echo "Mask, mesh, model, report and picture:"
ls -1 demo-out

#!/usr/bin/env bash
# The main job on real data: the brain in a T1 head MRI, with no hand on it. Results land in demo-out/.
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

#!/usr/bin/env bash
# Installs the built library into a scratch folder and links docs' ten-line program against it.
set -euo pipefail
cd "$(dirname "$0")/.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install build/release --prefix "$scratch/prefix" >/dev/null
cmake -S docs/example -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
cmake --build "$scratch/build"
"$scratch/build/example"
"$scratch/prefix/bin/pellicle" segment --preset list | grep -q brain-t1

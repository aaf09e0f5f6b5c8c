#!/usr/bin/env bash
# Installs the built library into a temporary folder, and builds and runs the program of docs/example with it.
set -euo pipefail
cd "$(dirname "$0")/.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install build/release --prefix "$scratch/prefix" >/dev/null
if find "$scratch/prefix" -path "*/internal/*" | grep .; then echo "private headers are installed"; exit 1; fi
cmake -S docs/example -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/prefix" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
cmake --build "$scratch/build"
"$scratch/build/example"
"$scratch/prefix/bin/pellicle" segment --preset list | grep -q brain-t1

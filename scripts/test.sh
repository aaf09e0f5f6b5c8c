#!/usr/bin/env bash
# Installs packages, builds, and runs every test.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh release
ctest --preset release -j "$(nproc)"

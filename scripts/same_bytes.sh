#!/usr/bin/env bash
# Proof of a refactoring: two programs, the same commands, the same bytes. `scripts/same_bytes.sh --help` says how.
exec python3 -B "$(dirname "$0")/same_bytes/compare.py" "$@"

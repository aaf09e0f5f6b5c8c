#!/usr/bin/env bash
# Seconds of two programs for the same commands, one after the other in turn. `scripts/old_and_new_speed.sh --help` says how.
exec python3 -B "$(dirname "$0")/same_bytes/speed.py" "$@"

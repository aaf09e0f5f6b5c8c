#!/usr/bin/env bash
# What Snakemake wants to know of a job: running, success or failed. The controller knows jobs of the last minutes, on any
# cluster; sacct knows older ones, where the cluster keeps accounts.
answer=$(scontrol show job "$1" --oneliner 2>&1)
state=$(grep -o -m 1 'JobState=[A-Z_]*' <<<"$answer" | head -n 1 | cut -d= -f2)
[ -n "$state" ] || state=$(sacct -j "$1" --format=State --noheader --parsable2 2>/dev/null | head -n 1)
# A job that nobody remembers will never end: it is done anew, which is cheap, as what it had finished is kept.
[ -n "$state" ] || [[ $answer != *"Invalid job id"* ]] || state=FORGOTTEN
case "$state" in
  COMPLETED) echo success ;;
  ""|PENDING|CONFIGURING|RUNNING|COMPLETING|STAGE_OUT|STOPPED|SUSPENDED|RESIZING|SIGNALING|REQUEUED) echo running ;;
  *) echo failed ;;
esac

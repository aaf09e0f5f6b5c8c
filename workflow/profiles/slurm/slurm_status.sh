#!/usr/bin/env bash
# Prints the state of a job for Snakemake: running, success or failed. The controller knows the jobs of the last minutes, on any
# cluster; sacct also knows older jobs, on clusters with accounting.
answer=$(scontrol show job "$1" --oneliner 2>&1)
state=$(grep -o -m 1 'JobState=[A-Z_]*' <<<"$answer" | head -n 1 | cut -d= -f2)
[ -n "$state" ] || state=$(sacct -j "$1" --format=State --noheader --parsable2 2>/dev/null | head -n 1)
# A job unknown to both counts as failed. Snakemake then runs it again, which is cheap: cases that had finished are kept.
[ -n "$state" ] || [[ $answer != *"Invalid job id"* ]] || state=FORGOTTEN
case "$state" in
  COMPLETED) echo success ;;
  ""|PENDING|CONFIGURING|RUNNING|COMPLETING|STAGE_OUT|STOPPED|SUSPENDED|RESIZING|SIGNALING|REQUEUED) echo running ;;
  *) echo failed ;;
esac

#!/usr/bin/env bash
# What Snakemake wants to know of a job: running, success or failed.
state=$(sacct -j "$1" --format=State --noheader --parsable2 2>/dev/null | head -n 1)
case "$state" in
  COMPLETED) echo success ;;
  ""|PENDING|CONFIGURING|RUNNING|COMPLETING|SUSPENDED|REQUEUED) echo running ;;
  *) echo failed ;;
esac

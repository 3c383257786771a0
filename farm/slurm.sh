#!/usr/bin/env bash
# Runs the lines of `wavepath parts` as an array job of Slurm, and the last one, which merges, after all of them.
#
#   wavepath parts SCENE --count 16 --spp 4096 -o picture.exr > job.txt
#   farm/slurm.sh job.txt [options of sbatch, such as --partition=long --time=02:00:00]
#
# Prints the number of the job that merges. All machines see the folder that it is submitted from, and have `wavepath`
# on their PATH. A task that is preempted, killed or out of time is queued again and goes on from its last state.
#SBATCH --job-name=wavepath
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:INT@60
set -euo pipefail

submit() {
  local job last array
  job="$(realpath "$1")"
  shift
  last="$(wc -l <"$job")"
  ((last >= 2)) || { echo "$job: has $last lines; write it with 'wavepath parts'" >&2 && exit 2; }
  array="$(sbatch --parsable --array="1-$((last - 1))" "$@" "$0" --line "$job")"
  sbatch --parsable --dependency="afterok:${array%%;*}" --kill-on-invalid-dep=yes "$@" "$0" --line "$job" "$last"
}

# Slurm's signal reaches this shell, which hands it on. A render then saves its state and ends with 130; its task is
# queued again.
run_line() {
  local job="$1" number="${2:-${SLURM_ARRAY_TASK_ID:?is set by Slurm}}" code=0 child
  local is_told=no
  eval "exec $(sed -n "${number}p" "$job")" &
  child=$!
  # TERM, since a background process ignores INT.
  trap 'is_told=yes; kill -TERM "$child" 2>/dev/null || true' INT TERM
  wait "$child" || code=$?
  while [[ $is_told == yes ]]; do # the signal had ended the wait
    is_told=no code=0
    wait "$child" || code=$?
  done
  if ((code == 130)) && [[ ${SLURM_JOB_ID:-} ]]; then
    scontrol requeue "$SLURM_JOB_ID"
    sleep 60 # until Slurm ends this shell
  fi
  exit "$code"
}

if [[ $1 == --line ]]; then
  shift
  run_line "$@"
else
  submit "$@"
fi

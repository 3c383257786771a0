#!/usr/bin/env bash
# Runs the lines of `wavepath parts` by GNU Parallel, here or over ssh, and the last one, which merges, after all of them.
#
#   wavepath parts SCENE --count 16 --spp 4096 -o picture.exr > job.txt
#   farm/parallel.sh job.txt                                    one after the other on this machine
#   farm/parallel.sh job.txt --sshlogin 1/render1,1/render2     a line at a time on each of these machines
#
# All machines see the current folder under the same path, and have `wavepath` on their PATH. A line that fails is tried
# three times, on another machine if there is one, and goes on from its last state. The same command goes on with lines
# that were not finished, whatever ended it.
set -euo pipefail
job="$(realpath "$1")"
shift
command -v parallel >/dev/null || { echo "parallel.sh: GNU Parallel is missing; apt install parallel" >&2 && exit 1; }
head -n -1 "$job" | parallel --jobs 1 --retries 3 --workdir "$PWD" --joblog "$job.log" --resume-failed "$@"
eval "exec $(tail -n 1 "$job")"

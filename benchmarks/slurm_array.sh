#!/bin/bash
# One picture on many machines: an array job renders a range of samples each, a job after it joins them, bit for bit what one
# machine of that kind would have made of them all.
#
#   id=$(sbatch --parsable --array=0-15 benchmarks/slurm_array.sh SCENE FOLDER SPP [flags of 'wavepath render' ...])
#   sbatch --dependency=afterok:$id benchmarks/slurm_array.sh --merge FOLDER
#
# FOLDER lies on a file system that all machines see. A task that is preempted or killed goes on from its last state when the
# scheduler starts it again; one that was finished has nothing left to do.
#SBATCH --job-name=wavepath
#SBATCH --requeue
#SBATCH --time=04:00:00
set -euo pipefail
wavepath=${WAVEPATH:-wavepath}

if [ "$1" = --merge ]; then
  folder=$2
  exec "$wavepath" merge "$folder"/part-*.exr -o "$folder/picture.exr" -o "$folder/picture.png"
fi

scene=$1 folder=$2 spp=$3
shift 3
task=$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN)) count=$SLURM_ARRAY_TASK_COUNT
first=$((spp * task / count)) last=$((spp * (task + 1) / count))
part=$(printf '%s/part-%05d' "$folder" "$task")
mkdir -p "$folder"
# --spp of the whole: the stratified sampler lays its strata out for it.
exec "$wavepath" render "$scene" --spp "$spp" --samples "$first:$last" -o "$part.exr" \
  --stats "$part.json" --checkpoint "$part.state" --resume "$@"

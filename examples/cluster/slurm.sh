#!/usr/bin/env bash
#SBATCH --job-name=cullscope-sweep
#SBATCH --cpus-per-task=1
#SBATCH --output=cullscope-sweep-%a.out
# One part of a sweep for each task of the array: sbatch --array=1-N slurm.sh SPEC.toml DIR
set -euo pipefail
spec=$1
out=$2/part-$SLURM_ARRAY_TASK_ID
resume=()
[ -e "$out/log.jsonl" ] && resume=(--resume)
exec "${CULLSCOPE:-cullscope}" sweep "$spec" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_MAX" --out "$out" "${resume[@]}"

#!/bin/sh
# Shares out a film as a job array of Slurm: each task draws a range of frames into one folder that all nodes see.
# Submit it again and only missing frames are drawn; a task that is preempted or killed is requeued and goes on where it stopped.
#
#   sh scripts/film_slurm.sh PRESET FOLDER [FLAG...]
#
# FLAG is any flag of rasterlab sequence, for instance --size 1920x1080 --fps 24 --turntable. Environment:
#   RASTERLAB      the program, under the same path on all nodes [rasterlab]
#   FRAMES         frames of a task [25]
#   VIDEO          also join the frames into this .mp4, .webm or .gif, in a job after the array
#   SBATCH_FLAGS   more flags of sbatch, for instance --partition=gpu --gres=gpu:1 --time=1:00:00
#
# It prints the number of the last job that it submits.
set -eu

# A task of the array: the numbers stand in front of the arguments.
if [ "${1:-}" = --task ]; then
    frames=$2
    count=$3
    rasterlab=$4
    preset=$5
    folder=$6
    shift 6
    from=$((SLURM_ARRAY_TASK_ID * frames))
    to=$((from + frames))
    if [ "$to" -gt "$count" ]; then to=$count; fi
    exec "$rasterlab" sequence "$preset" -o "$folder/frame_{frame:6}.png" "$@" --quiet --frames "$from..$to"
fi
if [ "${1:-}" = --join ]; then
    rasterlab=$2
    preset=$3
    folder=$4
    video=$5
    shift 5
    exec "$rasterlab" sequence "$preset" -o "$folder/frame_{frame:6}.png" "$@" --video "$video"
fi

if [ $# -lt 2 ]; then
    echo "usage: sh scripts/film_slurm.sh PRESET FOLDER [FLAG of rasterlab sequence...]" >&2
    exit 2
fi
if ! command -v sbatch >/dev/null 2>&1; then
    echo "film_slurm: sbatch of Slurm is not installed (on Debian and Ubuntu: sudo apt install slurm-wlm)" >&2
    exit 2
fi
preset=$1
folder=$2
shift 2
rasterlab=$(command -v "${RASTERLAB:-rasterlab}") || {
    echo "film_slurm: there is no program ${RASTERLAB:-rasterlab}; name it with RASTERLAB" >&2
    exit 2
}
frames=${FRAMES:-25}

count=$("$rasterlab" sequence "$preset" "$@" --count)
# Slurm takes arrays of a thousand tasks unless it is told otherwise.
while [ $(((count + frames - 1) / frames)) -gt 1000 ]; do frames=$((frames * 2)); done
tasks=$(((count + frames - 1) / frames))
mkdir -p "$folder"

# SBATCH_FLAGS is a list of words.
# shellcheck disable=SC2086
job=$(sbatch --parsable --job-name=rasterlab --requeue --array="0-$((tasks - 1))" --output="$folder/slurm-%A_%a.txt" ${SBATCH_FLAGS:-} \
    "$0" --task "$frames" "$count" "$rasterlab" "$preset" "$folder" "$@")
if [ -n "${VIDEO:-}" ]; then
    # shellcheck disable=SC2086
    job=$(sbatch --parsable --job-name=rasterlab-video --dependency="afterok:$job" --output="$folder/slurm-%j.txt" ${SBATCH_FLAGS:-} \
        "$0" --join "$rasterlab" "$preset" "$folder" "$VIDEO" "$@")
fi
echo "$job"

#!/bin/sh
# Shares out a film with GNU parallel: each job draws a range of frames into one folder. Run it again and only missing frames are drawn.
#
#   sh scripts/film_parallel.sh PRESET FOLDER [FLAG...]
#
# FLAG is any flag of rasterlab sequence, for instance --size 1920x1080 --fps 24 --turntable. Environment:
#   RASTERLAB        the program [rasterlab]
#   FRAMES           frames of a job [25]
#   JOBS             jobs at a time on each machine [1]: one device draws one frame at a time
#   VIDEO            also join the frames into this .mp4, .webm or .gif
#   PARALLEL_FLAGS   more flags of parallel, for instance --sshlogin two,three; all machines see FOLDER under the same path
set -eu

if [ $# -lt 2 ]; then
    echo "usage: sh scripts/film_parallel.sh PRESET FOLDER [FLAG of rasterlab sequence...]" >&2
    exit 2
fi
if ! command -v parallel >/dev/null 2>&1; then
    echo "film_parallel: GNU parallel is not installed (on Debian and Ubuntu: sudo apt install parallel)" >&2
    exit 2
fi
preset=$1
folder=$2
shift 2
rasterlab=${RASTERLAB:-rasterlab}
frames=${FRAMES:-25}

count=$("$rasterlab" sequence "$preset" "$@" --count)
mkdir -p "$folder"

# A job that is killed is tried again; it goes on where it stopped. PARALLEL_FLAGS is a list of words.
# shellcheck disable=SC2086
seq 0 "$frames" $((count - 1)) | while read -r from; do
    to=$((from + frames))
    if [ "$to" -gt "$count" ]; then to=$count; fi
    echo "$from..$to"
done | parallel --will-cite --quote --jobs "${JOBS:-1}" --retries 3 ${PARALLEL_FLAGS:-} \
    "$rasterlab" sequence "$preset" -o "$folder/frame_{frame:6}.png" "$@" --quiet --frames '{}' >/dev/null

if [ -n "${VIDEO:-}" ]; then
    "$rasterlab" sequence "$preset" -o "$folder/frame_{frame:6}.png" "$@" --video "$VIDEO"
fi
echo "$count frames in $folder"

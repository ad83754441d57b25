#!/bin/sh
# Goes through the first hour of a new user in the window, with keys and the mouse of a virtual screen: opens a model, tries five presets on it,
# combines three effects, animates one, saves, starts again, exports a film, compares and measures. After every step something that can be
# observed must have happened: a title, a line of the log, a file, the kept session, or the picture. A picture of the window after each step
# lies in FOLDER.
#
#   sh scripts/first_hour.sh FOLDER                 with the engine of the package assimp-testmodels
#   sh scripts/first_hour.sh FOLDER fox.glb         with another model
#   RASTERLAB="rasterlab --adapter llvmpipe" sh scripts/first_hour.sh FOLDER
#   SIZE=900x600 THEME=light sh scripts/first_hour.sh FOLDER     another size of the window, from 900x600; another theme
#   PACE=3 sh scripts/first_hour.sh FOLDER                       slower, on a machine that does other things too
#
# Each step is printed with the longest frame of the window in it, and with the longest time from an input to its picture, milliseconds: of
# pictures that compiled nothing, and of those that did. They mean something only while the machine does nothing else.
#
# Exit code 0: every step worked; 1: one did not, its name is the last line; 2: something is missing.
set -eu

if [ "${FIRST_HOUR:-}" != inside ]; then
    [ $# -ge 1 ] || { echo "usage: sh scripts/first_hour.sh FOLDER [MODEL.glb]" >&2; exit 2; }
    for tool in xvfb-run xdotool import compare; do
        command -v "$tool" > /dev/null || { echo "first_hour: $tool is missing; sudo apt install xvfb xauth xdotool imagemagick" >&2; exit 2; }
    done
    here="$(cd "$(dirname "$0")/.." && pwd)"
    # -r: no key repeats, which a busy machine would take for keys that are held.
    FIRST_HOUR=inside RASTERLAB="${RASTERLAB:-$here/target/release/rasterlab}" WAYLAND_DISPLAY='' \
        exec xvfb-run -a -s "-screen 0 ${SIZE:-1280x800}x24 -noreset -r" sh "$0" "$@"
fi

model="${2:-/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb}"
[ -f "$model" ] || { echo "first_hour: there is no model $model" >&2; exit 2; }
mkdir -p "$1"
pictures="$(cd "$1" && pwd)"
model="$(cd "$(dirname "$model")" && pwd)/$(basename "$model")"
name="$(basename "$model")"
name="${name%.*}"
size="${SIZE:-1280x800}"
width="${size%x*}"
height="${size#*x}"
work="$(mktemp -d)"
log="$work/window.log"
session="$work/rasterlab/session.toml"
export XDG_CONFIG_HOME="$work"
touch "$log"
mkdir -p "$work/rasterlab"
cat > "$work/rasterlab/settings.toml" << END
theme = "${THEME:-dark}"
[window]
size = [$width, $height]
END
lab_pid=''
cleanup() {
    [ -z "$lab_pid" ] || kill "$lab_pid" 2> /dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT

number=0
step=''
noted=0

# Takes the picture of a step.
shot() {
    import -window root "$pictures/$(printf %02d "$number")-$step.png"
}

begin() {
    number=$((number + 1))
    step="$1"
}

# Waits until a command succeeds, at most so many seconds at the usual pace; then the picture of the step is taken.
until_true() {
    patience="$(awk "BEGIN { print int($1 * ${PACE:-1} + 0.5) }")"
    shift
    tries=$((patience * 4))
    while ! "$@" > /dev/null 2>&1; do
        tries=$((tries - 1))
        if [ "$tries" -le 0 ]; then
            shot
            tail -n 5 "$log" "$work/out.txt" >&2
            kill -0 "$lab_pid" 2> /dev/null || echo "first_hour: the program has ended" >&2
            echo "first_hour: $step: not within $patience s: $*" >&2
            exit 1
        fi
        sleep 0.25
    done
}

# The numbers behind a word in the lines of the log that the step has added, the largest last.
numbers() { tail -n "+$((noted + 1))" "$log" | sed -nE "s/^timing: .*$1 ([0-9]+) ms.*/\\1/p" | sort -n; }
largest() { numbers "$1" | tail -n 1; }

done_step() {
    # Notes of timings come a second after what they tell of.
    nap 1.5
    shot
    printf '%02d %-22s longest frame %5s ms, slowest picture %5s ms, compiled %5s ms\n' "$number" "$step" "$(largest longest)" \
        "$(largest '[0-9] pictures[^,]*, slowest')" "$(largest 'compiled pictures[^,]*, slowest')"
    noted="$(wc -l < "$log")"
}

title_has() { xdotool search --name rasterlab getwindowname 2> /dev/null | grep -qF -- "$1"; }
log_has() { grep -qF -- "$1" "$log"; }
session_has() { grep -qF -- "$1" "$session"; }
# The picture in the middle of the window differs from that of the last call in more than 400 pixels.
middle() { import -window root -crop "$((width * 36 / 100))x$((height / 2))+$((width * 27 / 100))+$((height * 16 / 100))" +repage "$work/$1.png"; }
picture_changed() {
    middle now
    # compare exits with 1 where pictures differ.
    count="$(compare -metric AE -fuzz 3% "$work/before.png" "$work/now.png" null: 2>&1 || true)"
    [ "${count%%[. e]*}" -gt 400 ]
}

# The log tells of a picture that answers an input of this step, and the window shows it in place of the last one.
picture_arrived() {
    tail -n "+$((noted + 1))" "$log" | grep -q "pictures after their inputs" && picture_changed
}

# A person looks before going on, and so does this script; on a busy machine it must look longer.
nap() { sleep "$(awk "BEGIN { print $1 * ${PACE:-1} }")"; }
key() { xdotool key --clearmodifiers "$@"; nap 0.4; }
write() { xdotool type --delay 25 "$1"; nap 0.5; }
click() { xdotool mousemove "$1" "$2"; nap 0.3; xdotool click 1; nap 0.5; }
# Carries out an entry of the command palette.
palette() { key ctrl+k; write "$1"; key Return; }

# Starts the window and waits for its first picture.
start() {
    # RASTERLAB may hold arguments.
    # shellcheck disable=SC2086
    $RASTERLAB --log "$log" "$@" > "$work/out.txt" 2>&1 &
    lab_pid=$!
    until_true 60 title_has " - rasterlab"
    xdotool search --name rasterlab windowfocus 2> /dev/null || true
    sleep 2
}

begin start
start
until_true 20 log_has "adapter: "
done_step

begin open-model
key ctrl+o
write "$model"
key Return
until_true 60 title_has "$name"
until_true 20 log_has "Opened $name"
done_step

for preset in comic engraving one-bit xray wireframe-cage; do
    begin "preset-$preset"
    middle before
    key ctrl+k
    write "open ($preset)"
    shot
    key Return
    until_true 60 session_has "id = \"$preset-$name\""
    title_has " on $name" || until_true 1 title_has " on $name"
    until_true 180 picture_arrived
    done_step
done

begin combine-three
palette "open (teapot)"
until_true 60 session_has "id = \"teapot-$name\""
middle before
key shift+a
write facet
shot
key Return
until_true 20 session_has "[effects.facet]"
for effect in toon outline; do
    middle before
    palette "enable $effect"
    until_true 20 session_has "[effects.$effect]"
done
until_true 20 picture_changed
done_step

begin animate
palette "clock.time_s 0"
palette "facet.amount 1"
# The palette leads to the row, whose number has the focus; the diamond beside it is the next control.
# A busy machine may take the keys before the row has the focus; then they are pressed once more.
tries=3
until session_has "[animation.facet]" || [ "$tries" -le 0 ]; do
    tries=$((tries - 1))
    palette "facet.amount"
    nap 1
    key Tab
    key Return
    nap 4
done
until_true 20 session_has "[animation.facet]"
palette "clock.time_s 2"
palette "facet.amount 0"
until_true 20 session_has "{ time_s = 2.0, value = 0.0 }"
done_step

begin play
middle before
key space
until_true 20 picture_changed
key space
done_step

begin save
saved="$work/first-hour.toml"
key ctrl+s
write "$saved"
shot
key Return
until_true 20 test -s "$saved"
grep -q "animation.facet" "$saved"
until_true 10 session_has "path = \"$saved\""
done_step

begin reopen
key ctrl+q
tries=80
while kill -0 "$lab_pid" 2> /dev/null; do
    tries=$((tries - 1))
    [ "$tries" -gt 0 ] || until_true 0 false
    sleep 0.25
done
start
until_true 30 session_has "path = \"$saved\""
session_has "running = true" || until_true 10 session_has "running = true"
done_step

begin slider
# The first slider of the first effect; on a slow adapter the picture is smaller while it moves.
middle before
xdotool mousemove $((width - 200)) 170
nap 0.3
xdotool mousedown 1
for to in $(seq 198 -2 140); do
    xdotool mousemove $((width - to)) 170
    sleep 0.1
done
xdotool mouseup 1
until_true 20 picture_changed
began="$noted"
done_step
ended="$noted"
noted="$began"
median="$(numbers '[0-9] pictures[^,]*: median' | awk '{ all[NR] = $1 } END { print all[int((NR + 1) / 2)] }')"
noted="$ended"
echo "   a step of the slider was seen after $median ms (median)"
key ctrl+z

begin own-picture
# Into a folder that is not there yet, away from the model.
picture="$work/pictures/first-hour-shot.png"
key ctrl+e
key ctrl+a
write "$picture"
key Return
until_true 60 log_has "Saved $picture"
key ctrl+o
write "$picture"
key Return
until_true 60 session_has "path = \"$picture\""
done_step
key ctrl+z

begin own-line
palette "copy preset"
palette "open (teapot)"
until_true 60 session_has "id = \"teapot-$name\""
palette "paste preset"
until_true 60 log_has "Pasted a preset"
until_true 20 session_has "[animation.facet]"
done_step
key ctrl+z
key ctrl+z
until_true 20 session_has "path = \"$saved\""

begin film
film="$work/first-hour-film.png"
key ctrl+shift+e
key ctrl+a
write "$film"
# Width, height, the names of sizes and frames per second follow; Enter in the path exports.
key Tab
write 320
key Tab
write 240
key Tab
key Tab
write 10
key Tab
shot
for _ in 1 2 3 4 5; do key shift+Tab; done
key Return
until_true 240 log_has "Saved $film: "
test -s "$film"
done_step

begin compare
middle before
key shift+backslash
until_true 60 picture_changed
done_step
key Escape

begin verify
key v
until_true 120 log_has "verified "
done_step

begin measure
key m
sleep 1
click 54 $((height - 346))
# It waits while the pointer moves, so nothing is done until it ends.
until_true 480 log_has "Trade: combinations measured: "
done_step
key Escape

begin own-effect
palette "new effect of my own"
nap 1
write first_hour_ink
key Return
until_true 60 session_has "[effects.first_hour_ink]"
inked="$work/inked/mine.toml"
key ctrl+shift+s
key ctrl+a
write "$inked"
key Return
until_true 20 test -s "$inked"
# Elsewhere, and without the adapter that RASTERLAB may name: only the oracle blesses.
(cd / && "${RASTERLAB%% *}" bless "$inked" --snapshots "$work/goldens") >> "$work/out.txt" 2>&1
until_true 1 test -s "$work/goldens/mine.png"
done_step

if grep "^error: " "$log"; then
    echo "first_hour: the log of the window has errors" >&2
    exit 1
fi
cp "$log" "$pictures/window.log"
echo "first_hour: every step worked; the pictures are in $pictures"

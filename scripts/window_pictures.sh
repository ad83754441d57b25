#!/bin/sh
# Takes the pictures of the window for README.md and docs/guide.md on a virtual screen, with the keys and clicks of the guide's walk.
#
#   sh scripts/window_pictures.sh                 into docs/images
#   sh scripts/window_pictures.sh FOLDER          into another folder
#   PACE=3 sh scripts/window_pictures.sh          slower, on a machine that does other things too
#
# Look at every picture before it is committed: the script does not.
set -eu

if [ "${WINDOW_PICTURES:-}" != inside ]; then
    for tool in xvfb-run xdotool import pngquant; do
        command -v "$tool" > /dev/null || { echo "window_pictures: $tool is missing; sudo apt install xvfb xauth xdotool imagemagick pngquant" >&2; exit 2; }
    done
    cd "$(dirname "$0")/.."
    WINDOW_PICTURES=inside RASTERLAB="${RASTERLAB:-$PWD/target/release/rasterlab}" WAYLAND_DISPLAY='' \
        exec xvfb-run -a -s "-screen 0 1400x860x24 -noreset" sh "$0" "${1:-docs/images}"
fi

mkdir -p "$1"
pictures="$1"
work="$(mktemp -d)"
export XDG_CONFIG_HOME="$work"
lab_pid=''
trap '[ -z "$lab_pid" ] || kill "$lab_pid" 2> /dev/null || true; rm -rf "$work"' EXIT

nap() { sleep "$(awk "BEGIN { print $1 * ${PACE:-1} }")"; }
key() { xdotool key --clearmodifiers "$@"; nap 0.5; }
write() { xdotool type --delay 25 "$1"; nap 1; }
click() { xdotool mousemove "$1" "$2"; nap 0.3; xdotool click 1; nap 1; }
# The picture NAME of the window, whose size is WxH, without the pointer near anything, in 256 colors.
shot() {
    import -window root -crop "$2+0+0" +repage "$work/shot.png"
    pngquant --force --speed 1 --output "$pictures/$1.png" 256 "$work/shot.png"
    echo "$pictures/$1.png: $(wc -c < "$pictures/$1.png") bytes"
}
# Starts a window of this width and height, and waits for its first picture.
start() {
    mkdir -p "$work/rasterlab"
    printf 'theme = "dark"\n[window]\nsize = [%s, %s]\n' "$1" "$2" > "$work/rasterlab/settings.toml"
    shift 2
    "$RASTERLAB" "$@" > "$work/out.txt" 2>&1 &
    lab_pid=$!
    tries=60
    until xdotool search --name rasterlab windowfocus > /dev/null 2>&1; do
        tries=$((tries - 1))
        [ "$tries" -gt 0 ] || { cat "$work/out.txt" >&2; exit 1; }
        sleep 1
    done
    nap 10
}
stop() {
    kill "$lab_pid"
    wait "$lab_pid" 2> /dev/null || true
    rm -rf "$work/rasterlab"
}

start 1400 860 hero-etching
nap 10
key v
nap 15
shot window 1400x860
stop

start 1200 760 hero-day
shot guide-start 1200x760
click 120 92   # the search of the presets
write cel
click 120 215  # its first result
nap 5
xdotool mousemove 1016 389 mousedown 1  # the slider of toon.steps
for x in 1008 1000 994; do
    xdotool mousemove "$x" 389
    nap 0.3
done
xdotool mouseup 1
click 127 62   # the tab Effects
click 120 95   # its search
write outline
click 55 160
nap 5
key v
nap 8
shot guide-effect 1200x760
key ctrl+s
write comic-knot
key Return
nap 2
click 58 241   # New effect…
write ink
key Return
nap 4
sed -i 's|    let rim = .*|    let rim = step(0.5, fract(6.0 * s.position.y));|' "$work/rasterlab/presets/effects/ink.wgsl"
nap 6
shot guide-own-effect 1200x760
stop

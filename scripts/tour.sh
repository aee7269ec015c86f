#!/usr/bin/env bash
# Goes through the inspector as a new user would: a real window under Xvfb, real mouse events. Writes a picture of each step and
# checks by the files saved that every edit, the restart, the loading and the undoing did what they say.
#
#   scripts/tour.sh [SCALE] [FOLDER]    SCALE 1 (1280x720) or 2 (2560x1440, scale factor 2); pictures go to FOLDER
#
# Needs Xvfb, xdotool and ImageMagick. EXAMPLE names another binary than target/debug/examples/inspector.
set -euo pipefail
cd "$(dirname "$0")/.."

scale=${1:-1}
out=${2:-docs}
example=${EXAMPLE:-${CARGO_TARGET_DIR:-target}/debug/examples/inspector}
for tool in Xvfb xdotool import convert; do
    command -v "$tool" > /dev/null || {
        echo "tour: $tool is missing (on Debian or Ubuntu: apt-get install xvfb xdotool imagemagick)" >&2
        exit 1
    }
done
work=$(mktemp -d)
mkdir -p "$out"
cp -r assets "$work/assets"
feathers=$work/assets/feathers
groom=$work/assets/grooms/parrot.groom.ron
display=:$((70 + RANDOM % 900))
app=
Xvfb "$display" -screen 0 "$((1280 * scale))x$((720 * scale))x24" > "$work/xvfb.log" 2>&1 &
server=$!
export DISPLAY=$display
finish() {
    [ -z "$app" ] || kill "$app" 2> /dev/null || true
    kill "$server" 2> /dev/null || true
    rm -rf "$work"
}
trap finish EXIT
sleep 1

fail() {
    import -silent -window root "$out/tour_failure.png" || true
    tail -n 20 "$work/app.log" >&2 || true
    echo "tour: $* (see $out/tour_failure.png)" >&2
    exit 1
}

# All places are in points of a 1280x720 window: x y [width height].
px() { echo $(($1 * scale)); }
look() { # x y width height: a number for what is seen there
    import -silent -window root -crop "$(px "$3")x$(px "$4")+$(px "$1")+$(px "$2")" +repage rgb:- | md5sum
}
panel() { look 0 0 440 720; }
pause=0.5
settle() { # until the panels and the bird have not changed for a while
    local last now still=0
    last=$(look 0 0 1280 720)
    for _ in $(seq 1 600); do
        sleep "$pause"
        kill -0 "$app" 2> /dev/null || fail "the app is gone"
        now=$(look 0 0 1280 720)
        if [ "$now" = "$last" ]; then still=$((still + 1)); else still=0; fi
        [ "$still" -lt 2 ] || return 0
        last=$now
    done
    fail "the picture never comes to rest"
}
changed() { # OLD WHAT [x y width height]: waits until that part of the window (the panels) differs from before
    local old=$1 what=$2
    shift 2
    for _ in $(seq 1 600); do
        kill -0 "$app" 2> /dev/null || fail "the app is gone"
        if [ "$#" = 4 ]; then now=$(look "$@"); else now=$(panel); fi
        [ "$now" = "$old" ] || return 0
        sleep 0.1
    done
    fail "$what: nothing happens"
}
point() { xdotool mousemove "$(px "$1")" "$(px "$2")"; sleep "$pause"; }
click() { # x y [button]
    point "$1" "$2"
    xdotool mousedown "${3:-1}"
    sleep "$pause"
    xdotool mouseup "${3:-1}"
    sleep "$pause"
    settle
}
drag() { # x y x y
    point "$1" "$2"
    xdotool mousedown 1
    sleep "$pause"
    point $((($1 + $3) / 2)) $((($2 + $4) / 2))
    point "$3" "$4"
    xdotool mouseup 1
    sleep "$pause"
    settle
}
key() { xdotool key "$1"; sleep "$pause"; settle; }
picture() { # NAME: the window as it is, in few colours
    local suffix=
    [ "$scale" = 1 ] || suffix=_${scale}x
    import -silent -window root +dither -colors 200 -define png:compression-level=9 "$out/inspector_$1$suffix.png"
    echo "tour: $1"
}
start() {
    : > "$work/app.log"
    WINIT_X11_SCALE_FACTOR=$scale XDG_RUNTIME_DIR=$work "$example" --assets "$work/assets" \
        --size "$((1280 * scale))x$((720 * scale))" --time 0 --density 0.3 --lean \
        >> "$work/app.log" 2>&1 &
    app=$!
    for _ in $(seq 1 3000); do
        kill -0 "$app" 2> /dev/null || fail "the app did not start"
        ! grep -q "plumage of" "$work/app.log" || break
        sleep 0.1
    done
    xdotool search --sync --name bevy_plumage windowfocus > /dev/null
    point 700 690
    settle
    # How long an answer takes: a tab lights up under the pointer.
    local old begun
    old=$(look 60 65 100 26)
    begun=$(date +%s%N)
    xdotool mousemove "$(px 100)" "$(px 78)"
    changed "$old" "hovering" 60 65 100 26
    pause=$(awk -v ns=$(($(date +%s%N) - begun)) 'BEGIN { s = ns / 1e9; print (s < 0.15 ? 0.15 : s) }')
    echo "tour: an answer takes ${pause} s"
}
stop() {
    kill "$app"
    wait "$app" 2> /dev/null || true
    app=
}
regrown() { grep -c "plumage of" "$work/app.log"; }
wait_regrown() { # COUNT: until as many grooms have been built
    for _ in $(seq 1 3000); do
        [ "$(regrown)" -lt "$1" ] || { settle; return 0; }
        sleep 0.1
    done
    fail "the groom was not built"
}
value() { # FILE FIELD: the first number after it
    grep -o -m 1 "$2: *[-0-9.]*" "$1" | head -n 1 | grep -o '[-0-9.]*$'
}
differs() { [ "$1" != "$2" ] || fail "$3 is still $1"; echo "tour: $3 $1 -> $2"; }

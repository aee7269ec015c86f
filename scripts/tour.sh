#!/usr/bin/env bash
# Goes through the inspector as a new user would: a real window under Xvfb, real mouse events. Takes a picture of each step and fails
# when a step has no effect, judging by the saved files and the window's title.
#
#   scripts/tour.sh [SCALE] [FOLDER]    SCALE 1 (1280x720, all steps) or 2 (2560x1440, scale factor 2: the panels); pictures go to FOLDER
#
# Needs Xvfb, xdotool and ImageMagick. EXAMPLE names another binary than target/debug/examples/inspector; PATIENCE is how many seconds
# a step may take (a software renderer on a busy machine is slow).
set -euo pipefail
cd "$(dirname "$0")/.."

scale=${1:-1}
out=${2:-docs/inspector_tour}
example=${EXAMPLE:-${CARGO_TARGET_DIR:-target}/debug/examples/inspector}
patience=${PATIENCE:-600}
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
feather=$feathers/macaw_head.feather.ron
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
    mkdir -p target/test_failures
    import -silent -window root target/test_failures/tour.png || true
    tail -n 20 "$work/app.log" >&2 || true
    echo "tour: $* (see target/test_failures/tour.png; the title says: $(title))" >&2
    exit 1
}

# All places are in points of a window of 1280 x 720.
px() { echo $(($1 * scale)); }
look() { # [x y width height]: a number for what is seen there
    local x=${1:-0} y=${2:-0} w=${3:-1280} h=${4:-720}
    import -silent -window root -crop "$(px "$w")x$(px "$h")+$(px "$x")+$(px "$y")" +repage rgb:- | md5sum
}
painted() { # x y width height: whether more than a few colors are seen there
    [ "$(import -silent -window root -crop "$(px "$3")x$(px "$4")+$(px "$1")+$(px "$2")" +repage -format %k info:)" -gt 200 ]
}
frame() { title | grep -o '[0-9]*$' || echo 0; }
settle() { # until some frames later the window does not change any more
    local last now first still=0 end=$((SECONDS + patience))
    first=$(frame)
    while [ "$(frame)" -lt "$((first + ${1:-4}))" ]; do
        kill -0 "$app" 2> /dev/null || fail "the app is gone"
        [ "$SECONDS" -lt "$end" ] || fail "no frames"
        sleep 0.1
    done
    last=$(look)
    while [ "$SECONDS" -lt "$end" ]; do
        first=$(frame)
        while [ "$(frame)" = "$first" ]; do sleep 0.1; done
        now=$(look)
        if [ "$now" = "$last" ]; then still=$((still + 1)); else still=0; fi
        [ "$still" -lt 2 ] || return 0
        last=$now
    done
    fail "the picture never comes to rest"
}
until_() { # WHAT COMMAND...: waits until the command succeeds
    local what=$1 end=$((SECONDS + patience))
    shift
    until "$@"; do
        kill -0 "$app" 2> /dev/null || fail "the app is gone"
        [ "$SECONDS" -lt "$end" ] || fail "$what: nothing happens"
        sleep 0.2
    done
}
title() { xdotool search --name '^bevy_plumage' getwindowname 2> /dev/null | head -n 1; }
says() { # SECTION: what the title says of it
    title | tr '|' '\n' | grep "$1" | sed 's/^ *//; s/ *$//'
}
not() { ! "$@"; }
said() { [ "$(says "$1")" = "$2" ]; }
changed() { # SECTION OLD WHAT: waits until the title says something else
    until_ "$3" not said "$1" "$2"
    echo "tour: $3: $2 -> $(says "$1")"
}
same() { cmp -s "$1" "$2"; }
value() { # FILE FIELD: the first number after it
    grep -o -m 1 "$2: *[-0-9.]*" "$1" | head -n 1 | grep -o '[-0-9.]*$'
}
pause=0.4
point() { xdotool mousemove "$(px "$1")" "$(px "$2")"; sleep "$pause"; }
click() { # x y: pressed and let go at once, or a slow frame takes it for a long press
    point "$1" "$2"
    settle 2
    xdotool click 1
    sleep "$pause"
    settle 2
}
hold() { # x y: pressed for some frames, which is how a slider jumps
    point "$1" "$2"
    settle 2
    xdotool mousedown 1
    settle 2
    xdotool mouseup 1
    settle 2
}
drag() { # x y x y [button]
    local i
    point "$1" "$2"
    xdotool mousedown "${5:-1}"
    sleep "$pause"
    for i in 1 2 3 4 5 6; do
        xdotool mousemove "$(px $(($1 + ($3 - $1) * i / 6)))" "$(px $(($2 + ($4 - $2) * i / 6)))"
        sleep "$pause"
    done
    xdotool mouseup "${5:-1}"
    sleep "$pause"
    settle
}
wheel() { # x y TIMES: downwards
    local i
    point "$1" "$2"
    for i in $(seq "$3"); do
        xdotool click 5
        sleep 0.1
    done
    settle
}
picture() { # NAME: the window as it is, in few colors
    local suffix=
    [ "$scale" = 1 ] || suffix=_${scale}x
    import -silent -window root +dither -colors "$((64 / scale))" -define png:compression-level=9 -define png:compression-filter=1 -define png:compression-strategy=0 "$out/$1$suffix.png"
}
grown() { [ "$(grep -c "plumage of" "$work/app.log")" -ge "$1" ]; }
start() {
    : > "$work/app.log"
    WINIT_X11_SCALE_FACTOR=$scale XDG_RUNTIME_DIR=$work "$example" --assets "$work/assets" \
        --size 1280x720 --time 0 --density 0.15 --lean \
        >> "$work/app.log" 2>&1 &
    app=$!
    until_ "starting" grown 1
    xdotool search --sync --name '^bevy_plumage' windowfocus > /dev/null
    point 700 690
    until_ "growing feathers" not said feathers "0 feathers"
    # The first frames of feathers compile shaders; the preview is drawn after them.
    until_ "drawing the preview" painted 1100 130 90 200
    point 700 690
    settle 10
}
stop() {
    kill "$app"
    wait "$app" 2> /dev/null || true
    app=
}

# Places of the panels.
feather_tab="41 78" groom_tab="100 78" quality_tab="156 78" statistics_tab="218 78"
undo="34 130" save="40 151" name="118 151" save_as="193 151" load="243 151"
groom_save="40 130"
steps() { says "to undo"; }
save_feather() { # WHAT: saves, and waits until the file is another one
    cp "$feather" "$work/before"
    click $save
    until_ "$1" not same "$feather" "$work/before"
}

# Error budget, the LOD view, and the statistics; the running plot never rests.
quality_and_statistics() {
    local from last
    click $quality_tab
    from=$(says budget)
    drag 188 130 215 130
    changed budget "$from" "error budget dragged"
    settle
    picture error_budget
    click 207 151
    from=$(says view)
    click 182 218
    changed view "$from" "LOD view chosen"
    settle 10
    picture lod_view
    point $statistics_tab
    xdotool click 1
    last=$(frame)
    until_ "frames" eval '[ "$(frame)" -gt "$((last + 6))" ]'
    picture statistics
    stop
    echo "tour: done, pictures in $out"
}

# At another scale the panels are looked at, and a click and a drag must still meet what they aim at.
if [ "$scale" != 1 ]; then
    start
    picture feather
    wheel 200 600 12
    picture optics
    click $groom_tab
    picture groom
    quality_and_statistics
    exit
fi

start
picture feather
from=$(steps)

# Barb angle, with the barbs drawn over the preview.
before=$(value "$feather" barb_angle)
click 1022 430
drag 210 439 247 439
changed "to undo" "$from" "barb angle dragged"
said "to undo" "1 to undo, 0 to redo" || fail "a drag is one step: $(steps)"
settle
picture barb_angle
save_feather "saving the barb angle"
after=$(value "$feather" barb_angle)
[ "$before" != "$after" ] || fail "the barb angle is still $before"
echo "tour: barb angle in the file: $before -> $after"

# Color: the two sections above are folded, then the third stop gets another color.
click 70 376
click 50 200
click 70 263
from=$(steps)
click 101 347
drag 300 500 250 440
changed "to undo" "$from" "color picked"
settle
picture color
xdotool key Escape
save_feather "saving the color"
! diff <(grep -m 1 stops "$work/before") <(grep -m 1 stops "$feather") > /dev/null || fail "the colors are still the same"
echo "tour: colors in the file:$(grep -m 1 stops "$feather")"

# Under another name, then restart.
click $name
xdotool type --delay 50 a_tour
settle
click $save_as
until_ "saving under a name" test -s "$feathers/a_tour.feather.ron"
settle
picture saved
same "$feathers/a_tour.feather.ron" "$feather" || fail "the copy differs"
sed 's/barb_angle: [0-9.]*/barb_angle: 25.0/' "$feathers/a_tour.feather.ron" > "$work/other"
cp "$work/other" "$feathers/a_tour.feather.ron"
stop
start
[ "$(value "$feather" barb_angle)" = "$after" ] || fail "the restart changed the file"
picture restarted

# Load, by the first entry of the list.
from=$(steps)
click $load
picture load_list
click 285 176
changed "to undo" "$from" "loaded"
settle
picture loaded
save_feather "saving what was loaded"
same "$feather" "$feathers/a_tour.feather.ron" || fail "what was loaded is not what the file holds"

# A malformed file: its error is shown, and nothing changes.
cp "$feather" "$work/good"
printf '(\n    version: 1,\n    length_mm: "long",\n)\n' > "$feathers/a_broken.feather.ron"
sleep 2
from=$(steps)
panel=$(look 15 160 300 22)
click $load
click 285 176
message() { [ "$(look 15 160 300 22)" != "$panel" ]; }
until_ "the error of a malformed file" message
settle
picture malformed
[ "$(steps)" = "$from" ] || fail "a malformed file changed something: $(steps)"
rm "$feathers/a_broken.feather.ron"

# Ten steps, then all of them back.
from=$(steps)
for x in 180 190 200 210 220 230 240 250 260 270; do
    hold "$x" 243
done
changed "to undo" "$from" "ten times another length"
settle
until_ "ten steps" said "to undo" "$((${from%% *} + 10)) to undo, 0 to redo"
for _ in 1 2 3 4 5 6 7 8 9 10; do click $undo; done
until_ "ten steps back" said "to undo" "${from%% *} to undo, 10 to redo"
echo "tour: ten steps undone"
settle
picture undone
xdotool key ctrl+s
settle
same "$feather" "$work/good" || fail "ten steps back leave something else than before"

# Density of one region, and of the whole bird.
click $groom_tab
from=$(says feathers)
cp "$groom" "$work/before"
before=$(value "$groom" count)
drag 226 425 236 425
changed feathers "$from" "density of a region"
settle
picture groom
click $groom_save
until_ "saving the groom" not same "$groom" "$work/before"
echo "tour: feathers of the region in the file: $before -> $(value "$groom" count)"
from=$(says feathers)
drag 222 200 232 200
changed feathers "$from" "density of the bird"
settle
picture density

# A guide on both sides of the bird.
cp "$groom" "$work/before"
count=$(grep -c points "$groom")
click 109 281
drag 605 190 625 270
settle
picture guide
click $groom_save
until_ "saving the guide" not same "$groom" "$work/before"
[ "$(grep -c points "$groom")" -gt "$count" ] || fail "there is no new guide"
echo "tour: guides in the file: $count -> $(grep -c points "$groom")"
click 48 281

# A feather picked.
from=$(says picked)
click 625 215
changed picked "$from" "a click on the bird"
click $feather_tab
settle
picture picked

quality_and_statistics

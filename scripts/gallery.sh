#!/usr/bin/env bash
# Renders every picture of the README into docs/ and the figures beside them into docs/stats.
set -euo pipefail
cd "$(dirname "$0")/.."
out=docs
mkdir -p "$out" "$out/stats"
show() { # example, picture, arguments...
    local example=$1 picture=$2
    shift 2
    echo "gallery: $picture"
    ${CARGO:-cargo} run -q --features inspector,photo --example "$example" -- --headless --frames 1 --output "$out/$picture.png" --stats "$out/stats/$picture.json" "$@" >/dev/null
}
# Whole birds and heads, 1600 x 1200, without noise: frames averaged for each picture; more on a machine with a GPU. One run takes all
# pictures of a bird, with a mask for each; docs keeps copies of half the size.
samples=${SAMPLES:-8}
# Through the eagle's dark tail shines the sun: what is left of noise there shows more.
samples_of() { if [ "$1" = eagle ]; then echo $((2 * samples)); else echo "$samples"; fi; }
size=${SIZE:-1600x1200}
large=${GALLERY:-target/gallery}
birds=${BIRDS:-parrot eagle owl}
mkdir -p "$large"
table=$out/judged.md
cat >"$table" <<TEXT
# The birds, judged against photographs

\`make gallery\` measures its pictures of whole birds ($size, $samples frames, of the eagle $(samples_of eagle), in
\`target/gallery\`) and writes this page. Line numbers are those of a
list of what a photograph of a bird shows: 1 outline, 2 specks, 3 wing, 4 back, 5 proportions, 6 colors, 7 contrast by scale, 8 haze,
9 clipping, 12 what is around the bird. Bounds are from photographs of a golden eagle, a scarlet and a green-winged macaw
(\`crates/plumage_tools/src/judge\`); of a barn owl none was measured. Colors and contrast are those of feathers, outline and width
those of the whole bird, scales those of the bird whatever the size of the picture; of two birds the slimmer one is measured from behind.

| picture | line | what | found | wanted | |
|---|---|---|---|---|---|
TEXT
judge() { # bird, view, picture
    ${CARGO:-cargo} run -q -p plumage_tools --bin picture_judge -- "$1" "$2" "$large/$3.png" "$large/masks/$3.png" >>"$table" || true
}
for bird in $birds; do
    echo "gallery: $bird from four sides"
    ${CARGO:-cargo} run -q --features inspector,photo --example "$bird" -- --headless --size "$size" --accumulate "$(samples_of "$bird")" --depth-prepass \
        --shot "hero=$large/$bird.png" --shot "full=$large/${bird}_full.png" --shot "back=$large/${bird}_back.png" \
        --shot "head=$large/${bird}_head.png" --masks "$large/masks" --stats "$out/stats" >/dev/null
    for picture in "$bird" "${bird}_full" "${bird}_back" "${bird}_head"; do
        convert "$large/$picture.png" -colorspace RGB -filter Box -resize 50% -colorspace sRGB "$out/$picture.png"
    done
    judge "$bird" front "$bird"
    judge "$bird" side "${bird}_full"
    judge "$bird" back "${bird}_back"
    judge "$bird" head "${bird}_head"
done
show parrot parrot_stretch --size 640x480 --time 2.9
show parrot parrot_closeup --size 640x480 --camera closeup --time 0
show parrot parrot_macro --size 640x480 --camera macro --time 0
show parrot parrot_far --size 640x480 --camera far --time 0
show parrot parrot_cards --size 640x480 --time 0 --view card
show inspector inspector --size 1280x720 --time 1 --density 0.2
show eagle eagle_closeup --size 640x480 --camera closeup --time 0
show eagle eagle_stretch --size 640x480 --time 3.9
show owl owl_closeup --size 640x480 --camera closeup --accumulate "$samples"
show single_feather feather --size 480x640
show single_feather feather_back --size 480x640 --camera back
show single_feather feather_closeup --size 640x480 --camera closeup
show single_feather feather_macro --size 640x480 --camera macro
for side in full back; do
    show single_feather "covert_parrot_$side" --size 360x480 --feather macaw_blue --camera "$side" --env-samples 64
    show single_feather "covert_eagle_$side" --size 360x480 --feather eagle_greater --camera "$side" --env-samples 64
done
show single_feather feather_backlight --size 360x480 --backlight --env-samples 64
show eagle eagle_rim --size 640x480 --time 0 --camera closeup --backlight
show single_feather feather_barbs --size 640x480 --camera macro --distance 2.5
photo=$(mktemp -d)/photograph.jpg
${CARGO:-cargo} run -q -p plumage_tools --bin photo_charts -- --photograph eagle_secondary "$photo"
echo "gallery: extract_pair"
${CARGO:-cargo} run -q --features inspector,photo --example single_feather -- --headless --size 800x640 --photo "$photo" \
    --output "$out/extract_pair.png" --stats "$out/stats/extract_pair.json" >/dev/null
rm -r "$(dirname "$photo")"
for mode in explicit volume hybrid shells; do
    show fur "fur_$mode" --size 480x360 --mode "$mode"
done
show fur fur_closeup --size 480x360 --mode hybrid --camera closeup
# Fur on a model of your own: FOX names the Fox of the glTF sample models.
if [ -n "${FOX:-}" ]; then
    show fur fur_fox --size 480x360 --mode hybrid --mesh "$FOX" --time 0
fi
# The sun goes around shells with precomputed transfer.
for sun in 0 60 120 180 240 300; do
    show fur "fur_sun_$sun" --size 200x150 --mode shells --sun "$sun"
done
convert "$out"/fur_sun_{0,60,120}.png +append "$out/fur_sun_a.png"
convert "$out"/fur_sun_{180,240,300}.png +append "$out/fur_sun_b.png"
convert "$out"/fur_sun_{a,b}.png -append "$out/fur_lights.png"
rm "$out"/fur_sun_*.png "$out"/stats/fur_sun_*.json
# Five distances: the tiers of the volume.
for distance in 1 2 4 8 16; do
    show fur "fur_at_$distance" --size 200x150 --mode volume --distance "$distance"
done
convert "$out"/fur_at_{1,2,4,8,16}.png +append "$out/fur_dolly.png"
rm "$out"/fur_at_*.png "$out"/stats/fur_at_*.json
show chick chick --size 480x480 --time 0 --transparency hashed
show chick chick_moult --size 480x360 --camera closeup --time 0 --transparency hashed --density 0.3 --ruffle 1
show parrot parrot_ruffled --size 640x480 --camera closeup --distance 2.5 --tilt -55 --time 0 --ruffle 1 --transparency hashed
show parrot parrot_fluffed --size 640x480 --camera full --time 0 --ruffle 1
show eagle eagle_ruffled --size 640x480 --camera closeup --tilt -50 --time 0 --ruffle 1 --transparency hashed
# Clean, wet, dirty, old.
for weather in none wetness dirt age; do
    options=()
    [ "$weather" = none ] || options=("--$weather" 1)
    show single_feather "weather_$weather" --size 200x267 --feather macaw_contour --camera full "${options[@]}"
done
convert "$out"/weather_{none,wetness,dirt,age}.png +append "$out/weather.png"
rm "$out"/weather_*.png "$out"/stats/weather_*.json
show parrot parrot_wet --size 640x480 --camera closeup --distance 2.5 --time 0 --wetness 1
# One structural feather from three angles, as Chen et al. 2026, Fig. 17.
show single_feather feather_angle_0 --size 240x320 --feather macaw_blue --camera full
show single_feather feather_angle_40 --size 240x320 --feather macaw_blue --camera full --turn 40
show single_feather feather_angle_75 --size 240x320 --feather macaw_blue --camera full --turn 75
show single_feather feather_angle_180 --size 240x320 --feather macaw_blue --camera full --turn 180
# Thin layers: four feathers, and a rock dove's neck from all sides in the same light.
for feather in peacock_eye mallard_speculum pigeon_neck hummingbird_gorget; do
    show single_feather "iridescent_$feather" --size 240x320 --feather "$feather" --camera full
done
convert "$out"/iridescent_{peacock_eye,mallard_speculum,pigeon_neck,hummingbird_gorget}.png +append "$out/iridescent.png"
show pigeon pigeon --size 560x560
for angle in -36 -12 12 36 60; do
    show pigeon "iridescent_at_$angle" --size 180x260 --turn "$angle"
done
convert "$out"/iridescent_at_{-36,-12,12,36,60}.png +append "$out/iridescent_turn.png"
rm "$out"/iridescent_*_*.png "$out"/stats/iridescent_*.json
echo "gallery: curves, and the same feather as the plugin draws it"
${CARGO:-cargo} run -q -p plumage_tools --bin explicit_curves -- "$out"
echo "gallery: the birds, judged against photographs"
cat "$table"
echo "gallery: all pictures are in $out/"

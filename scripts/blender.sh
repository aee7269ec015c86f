#!/usr/bin/env bash
# The way of docs/blender.md, both directions: a bird from Blender, feathered, baked, validated, and looked at by Cycles. Everything goes
# into out/blender; Blender comes from the Python registry into scripts/blender/.venv, the validator from npm beside it.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo=${CARGO:-cargo}
here=scripts/blender
out=out/blender
python=$here/.venv/bin/python
if ! [ -x "$python" ]; then
    python3 -m venv $here/.venv
    $python -m pip install --quiet --requirement $here/requirements.txt
fi
mkdir -p $out
$python $here/feather.py $out/bird.glb
$cargo run --example your_own_mesh -- --headless --mesh $out/bird.glb --output $out/feathered.png --stats $out/feathered.json
$cargo run --example bake -- --mesh $out/bird.glb --output $out/baked
if command -v npm > /dev/null; then
    [ -d $here/node_modules/gltf-validator ] || npm install --silent --no-save --prefix $here gltf-validator@2.0.0-dev.3.10
    node $here/validate.js $out/baked.glb
else
    echo "npm is not there: $out/baked.glb was not validated"
fi
$python $here/look.py $out/baked $out/bird.glb

#!/bin/sh
# Packs the crate as for a registry and builds a guest that depends on the packed crate: the README's code as its main.rs, with the
# assets of the package. Then runs it for a few seconds where there is a display (or xvfb-run).
#
#   scripts/guest.sh [--check] [FOLDER]    --check only checks types; without FOLDER one is made and removed
#
# CARGO_TARGET_DIR is respected: with that of the repository, what is compiled there for the examples is used again.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
verb=build
if [ "${1:-}" = --check ]; then
    verb=check
    shift
fi
if [ $# -gt 0 ]; then
    guest=$1
    mkdir -p "$guest"
else
    guest=$(mktemp -d)
    trap 'rm -rf "$guest"' EXIT
fi
cd "$root"
CARGO_TARGET_DIR="$guest/packed" cargo package --quiet --offline --allow-dirty --no-verify
packed=$(ls "$guest"/packed/package/*.crate)
size=$(wc -c < "$packed")
echo "guest: the package has $size bytes"
[ "$size" -le 2000000 ] || { echo "guest: more than 2 MB" >&2; exit 1; }
tar -xzf "$packed" -C "$guest/packed"
crate=$guest/packed/$(basename "$packed" .crate)
mkdir -p "$guest/src"
# The first Rust code of the README, as it stands.
awk '/^```rust/ { inside = 1; next } /^```/ { if (inside) exit } inside' "$crate/README.md" > "$guest/src/main.rs"
grep -q PlumagePlugins "$guest/src/main.rs" || { echo "guest: the README has no code" >&2; exit 1; }
# The same versions, features and profiles as the examples have, so that what is compiled already can be used again.
cp "$root/Cargo.lock" "$guest/Cargo.lock"
ln -sfn "$crate/assets" "$guest/assets"
cat > "$guest/Cargo.toml" <<TOML
[package]
name = "guest"
version = "0.1.0"
edition = "2024"

[workspace]

[dependencies]
bevy_plumage = { path = "$crate" }

[dependencies.bevy]
version = "0.19.1"
default-features = false
features = ["3d_bevy_render", "area_light_luts", "bevy_window", "bevy_winit", "default_app", "keyboard", "mouse", "multi_threaded", "png", "std", "x11"]

TOML
awk '/^\[/ { inside = /^\[profile/ } inside' "$root/Cargo.toml" >> "$guest/Cargo.toml"
cargo "$verb" --offline --manifest-path "$guest/Cargo.toml"
if [ "$verb" = check ]; then
    echo "guest: checked"
    exit 0
fi
run="timeout 20 cargo run --offline --manifest-path $guest/Cargo.toml"
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    show=$run
elif command -v xvfb-run > /dev/null; then
    show="xvfb-run -a $run"
else
    echo "guest: built; no display to run it on"
    exit 0
fi
# 124: it still ran when its time was up, which is what a window does.
code=0
(cd "$guest" && $show) || code=$?
[ "$code" -eq 124 ] || [ "$code" -eq 0 ] || { echo "guest: left with $code" >&2; exit 1; }
echo "guest: built and ran"

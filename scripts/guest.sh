#!/bin/sh
# Builds a crate outside this repository that depends on bevy_plumage by path, next to bevy-inspector-egui, with the README's
# twenty lines as its main.rs; with the default features and with none. Runs it for a few seconds where there is a display (or
# xvfb-run). Usage: scripts/guest.sh [folder]; without a folder one is made and removed. CARGO_TARGET_DIR is respected.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
if [ $# -gt 0 ]; then
    guest=$1
    mkdir -p "$guest"
else
    guest=$(mktemp -d)
    trap 'rm -rf "$guest"' EXIT
fi
mkdir -p "$guest/src"
# The Rust code of the README, as it stands.
awk '/^```rust/ { inside = 1; next } /^```/ { if (inside) exit } inside' "$root/README.md" > "$guest/src/main.rs"
grep -q PlumagePlugins "$guest/src/main.rs" || { echo "guest: the README has no code" >&2; exit 1; }
# The same versions as here, so that what is compiled already can be used again.
cp "$root/Cargo.lock" "$guest/Cargo.lock"
ln -sfn "$root/assets" "$guest/assets"
write() {
    cat > "$guest/Cargo.toml" <<TOML
[package]
name = "guest"
version = "0.1.0"
edition = "2024"

[dependencies]
bevy = { version = "0.19.1", default-features = false, features = ["3d_bevy_render", "bevy_window", "bevy_winit", "default_app", "multi_threaded", "png", "std", "x11"] }
bevy_plumage = { path = "$root"$1 }
bevy-inspector-egui = { version = "0.37", default-features = false }

[profile.dev]
opt-level = 1
debug = "line-tables-only"

[profile.dev.package."*"]
opt-level = 3
debug = false
debug-assertions = false

[workspace]
TOML
}
for features in "" ", default-features = false"; do
    write "$features"
    echo "guest: bevy_plumage${features:-, default features}"
    cargo build --offline --manifest-path "$guest/Cargo.toml"
    copies=$(cargo tree --offline --manifest-path "$guest/Cargo.toml" --prefix none -i bevy_egui 2>/dev/null | grep -c '^bevy_egui ' || true)
    [ "$copies" -le 1 ] || { echo "guest: $copies versions of bevy_egui" >&2; exit 1; }
done
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

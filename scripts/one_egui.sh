#!/usr/bin/env bash
# Checks that an app with its own bevy_egui and bevy-inspector-egui that adds our inspector has exactly one egui (and one Bevy).
set -euo pipefail
cd "$(dirname "$0")/.."

guest=$(mktemp -d)
trap 'rm -rf "$guest"' EXIT
mkdir "$guest/src"
echo 'fn main() {}' > "$guest/src/main.rs"
cp Cargo.lock "$guest/" 2> /dev/null || true
cat > "$guest/Cargo.toml" << END
[package]
name = "guest"
version = "0.1.0"
edition = "2024"

[dependencies]
bevy = { version = "0.19.1", default-features = false }
bevy_egui = { version = "0.40", default-features = false, features = ["render"] }
bevy-inspector-egui = { version = "0.37", default-features = false, features = ["bevy"] }
bevy_plumage = { path = "$PWD", features = ["inspector", "photo"] }

[workspace]
END
tree=$(${CARGO:-cargo} tree --manifest-path "$guest/Cargo.toml" --prefix none --edges normal)
for crate in egui bevy_egui bevy-inspector-egui bevy wgpu naga; do
    versions=$(grep -E "^$crate v" <<< "$tree" | awk '{ print $2 }' | sort -u)
    if [ "$(wc -w <<< "$versions")" != 1 ]; then
        echo "an app with its own egui should have one $crate, but has:" $versions >&2
        exit 1
    fi
done
echo "an app with bevy_egui and bevy-inspector-egui has one egui: $(grep -m 1 -E '^egui v' <<< "$tree")"

#!/usr/bin/env bash
# Installs what is missing to build and render: a C linker and a Vulkan driver; with the argument `pictures` also ImageMagick, with
# `window` a virtual display and a tool that moves its mouse, with `radeon` Mesa's driver for Radeons and Vulkan's headers, with `tests` a
# C++ compiler (for FLIP). Does nothing where everything is present.
set -euo pipefail

need=()
command -v cc >/dev/null 2>&1 || need+=(gcc libc6-dev)

has_library() { ldconfig -p 2>/dev/null | grep -q "$1" || [ -e "/usr/lib/x86_64-linux-gnu/$1" ] || [ -e "/usr/lib/aarch64-linux-gnu/$1" ]; }
has_driver() {
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return 0
    compgen -G '/usr/share/vulkan/icd.d/*.json' >/dev/null || compgen -G '/etc/vulkan/icd.d/*.json' >/dev/null
}

for word in "$@"; do
    case "$word" in
    pictures) command -v convert >/dev/null 2>&1 || need+=(imagemagick) ;;
    window)
        command -v Xvfb >/dev/null 2>&1 || need+=(xvfb)
        command -v xdotool >/dev/null 2>&1 || need+=(xdotool)
        ;;
    tests) command -v c++ >/dev/null 2>&1 || need+=(g++) ;;
    radeon)
        has_library libvulkan_radeon.so || need+=(mesa-vulkan-drivers)
        [ -e /usr/include/vulkan/vulkan.h ] || need+=(libvulkan-dev)
        ;;
    *)
        echo "setup: unknown argument \"$word\"" >&2
        exit 1
        ;;
    esac
done

case "$(uname -s)" in
Linux)
    has_library libvulkan.so.1 || need+=(libvulkan1)
    has_driver || need+=(mesa-vulkan-drivers)
    if [ -n "${DISPLAY:-}" ]; then
        has_library libxkbcommon-x11.so.0 || need+=(libxkbcommon-x11-0)
        has_library libXcursor.so.1 || need+=(libxcursor1)
        has_library libXi.so.6 || need+=(libxi6)
        has_library libXrandr.so.2 || need+=(libxrandr2)
    fi
    ;;
*) ;;
esac

if ! command -v cargo >/dev/null 2>&1; then
    echo "setup: no cargo found. Install Rust 1.95 or newer (https://rustup.rs), then try again." >&2
    exit 1
fi
[ ${#need[@]} -eq 0 ] && exit 0

if ! command -v apt-get >/dev/null 2>&1; then
    echo "setup: missing: ${need[*]} (Debian names). Install your system's equivalents, then try again." >&2
    exit 1
fi
run=()
if [ "$(id -u)" -ne 0 ]; then
    if command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then
        run=(sudo -n)
    else
        echo "setup: missing: ${need[*]}. They need root to install; run: sudo apt-get install ${need[*]}" >&2
        exit 1
    fi
fi
echo "setup: installing ${need[*]}"
"${run[@]}" apt-get update -qq
"${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${need[@]}" >/dev/null

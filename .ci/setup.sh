# Read by ./run and ./test in the root of the checkout: installs what is missing, builds, and
# leaves the program's path in $recto.
set -eu

# Outside the checkout, so that a clean clone does not build Bevy again.
: "${CARGO_TARGET_DIR:=${XDG_CACHE_HOME:-$HOME/.cache}/recto/target}"
export CARGO_TARGET_DIR

# Mesa complains where there is none.
if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
    XDG_RUNTIME_DIR=${XDG_CACHE_HOME:-$HOME/.cache}/recto/runtime
    mkdir -p -m 700 "$XDG_RUNTIME_DIR"
    export XDG_RUNTIME_DIR
fi

# Whether the dynamic linker knows a library. ldconfig may be outside a user's PATH.
has_library() {
    PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null | grep -q "$1" && return
    for folder in /usr/lib /usr/lib64 /lib /lib64 /usr/local/lib /usr/lib/*-linux-gnu; do
        [ -e "$folder/$1" ] && return
    done
    return 1
}

has_vulkan_driver() {
    # The loader looks at nothing else where one of these is set.
    drivers=${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}
    [ -n "$drivers" ] && return
    for folder in /usr/share /usr/local/share /etc; do
        for driver in "$folder"/vulkan/icd.d/*.json; do
            [ -e "$driver" ] && return
        done
    done
    return 1
}

# Whether a folder of fonts has one that Recto knows to be Japanese (src/wording/fonts.rs).
has_japanese_font() {
    for folder in /usr/share/fonts /usr/local/share/fonts "$HOME/.local/share/fonts" "$HOME/.fonts"; do
        [ -d "$folder" ] || continue
        found=$(find "$folder" \( -name 'MTLc3m.ttf' -o -name 'NotoSansCJK-Regular.ttc' \
            -o -name 'NotoSansJP-Regular.*' -o -name 'VL-*Gothic-Regular.ttf' -o -name 'ipag*.ttf' \
            -o -name 'DroidSansFallback*.ttf' \) 2>/dev/null | head -n 1)
        [ -n "$found" ] && return
    done
    return 1
}

missing_packages() {
    command -v cc >/dev/null || echo build-essential
    has_library libvulkan.so.1 || echo libvulkan1
    has_vulkan_driver || echo mesa-vulkan-drivers
    # Legends and wordings have letters beyond ASCII: Latin, Greek, Cyrillic and Arabic, and Japanese.
    [ -e /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf ] || echo fonts-dejavu-core
    has_japanese_font || echo fonts-motoya-l-cedar
    # What a window loads at run time.
    has_library libX11.so.6 || echo libx11-6
    has_library libX11-xcb.so.1 || echo libx11-xcb1
    has_library libXcursor.so.1 || echo libxcursor1
    has_library libXi.so.6 || echo libxi6
    has_library libXrandr.so.2 || echo libxrandr2
    has_library libxkbcommon-x11.so.0 || echo libxkbcommon-x11-0
    # Tests open the window on an X server of their own.
    [ -z "${for_tests:-}" ] || command -v Xvfb >/dev/null || echo xvfb
}

install_packages() {
    packages=$(missing_packages | tr '\n' ' ')
    [ -n "$packages" ] || return 0
    if ! command -v apt-get >/dev/null; then
        echo "setup: please install what these Debian packages hold: $packages" >&2
        return 0
    fi
    sudo=
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "setup: please let an administrator run: apt-get install $packages" >&2
            return 0
        fi
        sudo=sudo
    fi
    echo "setup: missing here and installed now with apt-get: $packages" >&2
    # Each package is a word of its own.
    # shellcheck disable=SC2086
    if $sudo apt-get update -qq &&
        $sudo env DEBIAN_FRONTEND=noninteractive \
            apt-get install -y -qq --no-install-recommends $packages >/dev/null; then
        return 0
    fi
    echo "setup: apt-get failed; please install later: $packages" >&2
    # Nothing can be built or rendered without these.
    case " $packages" in
    *" build-essential "* | *" libvulkan1 "* | *" mesa-vulkan-drivers "*) exit 1 ;;
    esac
}

# Writes the maps of the sample exhibits unless the last one to be written is there.
sample_maps() {
    [ -e exhibits/landscape/maps/.complete ] && return
    echo "setup: drawing the sample exhibits (a minute or two)" >&2
    "$recto" sample exhibits >/dev/null
    : >exhibits/landscape/maps/.complete
}

PATH="$PATH:$HOME/.cargo/bin"
if ! command -v cargo >/dev/null; then
    echo "setup: Rust is missing; install it from https://rustup.rs" >&2
    exit 1
fi
install_packages
# Cargo tells checkouts that share a target folder apart by the times of their files alone, and
# would take what another one built, with that one's paths, for this one's.
owner=$CARGO_TARGET_DIR/checkout
if [ -e "$owner" ] && [ "$(cat "$owner")" != "$PWD" ]; then
    echo "setup: $(cat "$owner") was built here last, so Recto (not Bevy) is built anew" >&2
    cargo clean --quiet --release --package recto
fi
mkdir -p "$CARGO_TARGET_DIR"
echo "$PWD" >"$owner"
# A test target has to be named: it switches on the features that tests ask of shared crates.
# The program alone would be built with others, and `cargo test` would then build Bevy again.
# Before the whole suite all of them are built at once: Recto is compiled in one piece, by one processor,
# and by another one for its unit tests.
if [ -n "${for_tests:-}" ] && [ $# -eq 0 ]; then
    cargo build --release --locked --bin recto --tests
else
    cargo build --release --locked --bin recto --test cli
fi
recto=$CARGO_TARGET_DIR/release/recto

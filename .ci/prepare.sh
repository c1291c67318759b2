# Sourced by ./run and ./check: reads their option, installs what Debian packages are missing, builds a preset. Not a command of its own.
set -euo pipefail
command_file=$(realpath "$0")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build_packages=(
    g++ cmake ninja-build pkg-config ccache
    libvulkan-dev mesa-vulkan-drivers glslang-tools spirv-tools libglm-dev libglfw3-dev
    libopencv-dev libjpeg-dev libavformat-dev libavcodec-dev libswscale-dev libcgal-dev libcli11-dev nlohmann-json3-dev libfmt-dev libtinygltf-dev zlib1g-dev libembree-dev
    libimgui-dev libstb-dev fonts-dejavu-core libaravis-dev libusb-1.0-0-dev
)
test_packages=(
    libgtest-dev vulkan-validationlayers xvfb xauth mold
    xserver-xorg-core xserver-xorg-video-dummy x11-xserver-utils x11-utils openbox
)

say() { printf '\n== %s\n' "$*"; }

die() {
    printf '\nFAILED: %s\n' "$*" >&2
    exit 1
}

# take_option ALLOWED "$@": sets `option`, empty if there is none. Usage is the comment at the top of the command's file.
take_option() {
    local allowed=$1 usage
    shift
    option=${1:-}
    usage=$(sed -n '2,/^[^#]/s/^# //p' "$command_file")
    case $option in
    -h | --help)
        printf '%s\n' "$usage"
        exit 0
        ;;
    esac
    if [ $# -gt 1 ] || { [ $# -eq 1 ] && [ "$option" != "$allowed" ]; }; then
        printf 'unknown: %s\n%s\n' "$*" "$usage" >&2
        exit 2
    fi
}

# install_packages NAME...: those that are not there yet, as root or through sudo.
install_packages() {
    local missing=() name
    for name in "$@"; do
        dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null | grep -qx installed || missing+=("$name")
    done
    [ ${#missing[@]} -eq 0 ] && return
    say "Installing Debian packages: ${missing[*]}"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || die "these packages are needed, and there is no sudo to install them with: ${missing[*]}"
        as_root=(sudo)
    fi
    local log
    log=$(mktemp)
    "${as_root[@]}" apt-get update -qq >"$log" 2>&1 || { tail -5 "$log"; die "apt-get update did not work"; }
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" \
        >"$log" 2>&1 || { tail -20 "$log"; die "apt-get could not install: ${missing[*]}"; }
    rm -f "$log"
}

# build PRESET ON|OFF [TARGET...]: configures with or without tests and benches (none under the sanitizers), and builds; a broken
# configuration is started afresh.
build() {
    local preset=$1 log options=(-DHELIODON_TESTS="$2" -DHELIODON_FULL_BUILD=ON)
    [ "$preset" = asan ] || options+=(-DHELIODON_BENCHES="$2")
    shift 2
    mkdir -p "build/$preset"
    log=build/$preset/configure.log
    say "Building ($preset)"
    cmake --preset "$preset" "${options[@]}" >"$log" 2>&1 || {
        rm -rf "build/$preset/CMakeCache.txt" "build/$preset/CMakeFiles"
        cmake --preset "$preset" "${options[@]}" >"$log" 2>&1 || { tail -20 "$log"; die "cmake could not configure, see $log"; }
    }
    cmake --build "build/$preset" --parallel "$(nproc)" ${1:+--target "$@"} || die "the $preset build"
}

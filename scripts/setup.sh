#!/usr/bin/env bash
# Sets up a Debian 12 machine: installs the packages listed below, configures and builds. It can be run again at any time.
#   scripts/setup.sh [preset] [target ...]      default: release, all targets; SKIP_APT=1 installs no packages
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
shift || true

packages=(
  g++ cmake ninja-build ccache git ca-certificates
  libinsighttoolkit5-dev libgdcm-dev libnifti-dev libtiff-dev zlib1g-dev
  libceres-dev libsuitesparse-dev libeigen3-dev libopenvdb-dev libboost-iostreams-dev libembree-dev libosd-dev libtbb-dev
  libcli11-dev nlohmann-json3-dev libtomlplusplus-dev libspdlog-dev libfmt-dev libpugixml-dev libssl-dev libpng-dev
  libgtest-dev libgmock-dev libbenchmark-dev libnanoflann-dev
  clang-format clang-tidy
  python3 python3-nibabel python3-numpy python3-jsonschema
  mricron-data
  chromium
)

missing=()
for p in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$p" 2>/dev/null | grep -q 'install ok installed' || missing+=("$p")
done
if [ "${#missing[@]}" -gt 0 ] && [ "${SKIP_APT:-0}" != 1 ]; then
  sudo=
  [ "$(id -u)" = 0 ] || sudo=sudo
  $sudo apt-get update -qq
  DEBIAN_FRONTEND=noninteractive $sudo apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
cmake --preset "$preset" >"$log" 2>&1 || { cat "$log"; exit 1; }
if [ "$#" -gt 0 ]; then
  cmake --build --preset "$preset" --target "$@"
else
  cmake --build --preset "$preset"
fi

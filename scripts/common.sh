# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the other scripts. Gives ROOT (the package), and functions to build it.

set -euo pipefail
ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# Another python3 before the system's breaks catkin and ROS's tools.
export PATH=/usr/bin:$PATH
# The builds with and without ROS share what ccache has: precompiled headers lie in the folder of each.
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$ROOT}
export ROS_HOSTNAME=${ROS_HOSTNAME:-localhost}

say() { echo "posefusion: $*" >&2; }
fail() {
  say "$*"
  exit 1
}

# ROS outside /usr (Ubuntu) has to be sourced; its script uses unset variables.
if [ -z "${ROS_DISTRO:-}" ] && [ -f /opt/ros/noetic/setup.bash ]; then
  set +u
  # shellcheck disable=SC1091
  source /opt/ros/noetic/setup.bash
  set -u
fi

# Compilers need about 1.5 GB each: no more of them than memory allows.
build_jobs() {
  local cores memory_kb
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable/ {print $2}' /proc/meminfo)
  local most=$((memory_kb / 1500000))
  [ "$most" -ge 1 ] || most=1
  echo $((cores < most ? cores : most))
}

# build_package BUILD_DIR DEVEL_DIR TARGETS... [-- CMAKE_OPTIONS...]
build_package() {
  local build=$1 devel=$2
  shift 2
  local targets=()
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    targets+=("$1")
    shift
  done
  [ $# -eq 0 ] || shift
  # A build folder that came along with a copied tree belongs to the place it came from.
  local cache=$build/CMakeCache.txt
  if [ -f "$cache" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$ROOT" "$cache"; then
    say "$build was made for another folder: making it anew"
    rm -rf "$build" "$devel"
  fi
  mkdir -p "$build"
  say "building in $build (log: $build/build.log)"
  if ! {
    cmake -S "$ROOT" -B "$build" -DCATKIN_DEVEL_PREFIX="$devel" "$@" &&
      make -C "$build" -j"$(build_jobs)" "${targets[@]}"
  } >"$build/build.log" 2>&1; then
    grep -nE 'error|Error|\*\*\*' "$build/build.log" | head -n 20 >&2 || true
    tail -n 20 "$build/build.log" >&2
    fail "the build failed; the whole log is $build/build.log"
  fi
}

# The tree as it is now, without what is ignored, into a folder that is there: copy_tree FOLDER
copy_tree() {
  (cd "$ROOT" && git ls-files -z --cached --others --exclude-standard |
    while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    tar --null --files-from=- --create) | tar -C "$1" --extract
}

build_release() { build_package "$ROOT/build" "$ROOT/devel" "$@"; }

# Path of a program of the package in the ordinary build.
program() { echo "$ROOT/devel/lib/posefusion/$1"; }

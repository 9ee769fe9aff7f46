#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Builds and runs test/outside_package against what an install gives: with plain CMake against the core alone, and as a
# catkin package against all of it; and builds the core by itself, without catkin. usage: outside_package.sh REPOSITORY BUILD
set -euo pipefail
repository=$(cd "$1" && pwd) build=$(cd "$2" && pwd)
# The build's own devel space must not be seen, only what is installed (and ROS).
CMAKE_PREFIX_PATH=$(tr ':' '\n' <<<"${CMAKE_PREFIX_PATH:-}" | grep -v "^$build/" | paste -sd: || true)
export CMAKE_PREFIX_PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
options=(-DCMAKE_BUILD_TYPE=Release)
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi

# usage: cached NAME   an option of the build
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }
# usage: quietly COMMAND...   shows what a command says only if it fails
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; echo "outside_package.sh: FAILED: $*"; exit 1; }; }

# usage: try NAME PREFIX CMAKE_OPTIONS...   builds one of the packages, and runs it
try() {
  local name=$1 prefix=$2 path
  shift 2
  path=$prefix${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH}
  quietly cmake -S "$repository/test/outside_package/$name" -B "$work/$name" "${options[@]}" "$@" "-DCMAKE_PREFIX_PATH=${path//:/;}"
  quietly cmake --build "$work/$name" --target outside
  "$(find "$work/$name" -name outside -type f)"
  echo "outside_package.sh: ok: $name"
}

quietly cmake --install "$build" --component core --prefix "$work/core"
(cd "$work/core/include" && find semantic_vslam -name '*.h' | sort | sed 's/.*/#include "&"/') >"$work/every_header.cpp"
echo "outside_package.sh: $(wc -l <"$work/every_header.cpp") public headers"
try plain "$work/core" "-DEVERY_HEADER=$work/every_header.cpp"

quietly cmake --install "$build" --prefix "$work/all"
PATH=$(dirname "$(cached PYTHON_EXECUTABLE)"):$PATH  # another python3, first in PATH, breaks catkin
try catkin "$work/all"

# The core by itself. Where there is a compiler cache, it has all that this compiles; else configuring must do.
alone=$(dirname "$build")/core
options+=("-DONNXRUNTIME_ROOT=$(cached ONNXRUNTIME_ROOT)" "-DSEMANTIC_VSLAM_WARNINGS_AS_ERRORS=$(cached SEMANTIC_VSLAM_WARNINGS_AS_ERRORS)")
quietly cmake -S "$repository/src/core" -B "$alone" -G Ninja "${options[@]}" -DCMAKE_DISABLE_FIND_PACKAGE_catkin=ON
if command -v ccache >/dev/null; then quietly cmake --build "$alone"; fi
echo "outside_package.sh: ok: core by itself"

#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Builds and runs test/outside_package against what an install gives: with plain CMake against the core alone, and as a
# catkin package against all of it; runs the install space itself after it was moved, as on a robot that has neither sources
# nor caches; and builds the core by itself, without catkin. usage: outside_package.sh REPOSITORY BUILD
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
  quietly cmake -S "$repository/test/outside_package/$name" -B "$work/$name" -G Ninja "${options[@]}" "$@" "-DCMAKE_PREFIX_PATH=${path//:/;}"
  quietly cmake --build "$work/$name" --target outside
  "$(find "$work/$name" -name outside -type f)"
  echo "outside_package.sh: ok: $name"
}

quietly cmake --install "$build" --component core --prefix "$work/core"
(cd "$work/core/include" && find semantic_vslam -name '*.h' | sort | sed 's/.*/#include "&"/') >"$work/every_header.cpp"
echo "outside_package.sh: $(wc -l <"$work/every_header.cpp") public headers"
try plain "$work/core" "-DEVERY_HEADER=$work/every_header.cpp"

# catkin writes the files of the environment to the prefix that was configured, whatever --prefix says.
quietly cmake --install "$build" --prefix "$work/all"
quietly cp "$build"/catkin_generated/installspace/{_setup_util.py,setup.sh,setup.bash,env.sh} "$work/all/"
PATH=$(dirname "$(cached PYTHON_EXECUTABLE)"):$PATH  # another python3, first in PATH, breaks catkin
try catkin "$work/all"

moved=$work/robot/space
mkdir -p "$work/robot" "$work/images" && mv "$work/all" "$moved"
mkdir "$moved/share/semantic_vslam/test" && cp "$repository"/test/ros/*.py "$moved/share/semantic_vslam/test/"
# usage: on_robot COMMAND...
on_robot() {
  # shellcheck disable=SC2016  # $1 is the inner shell's
  env -i HOME="$work/robot" PATH="$PATH" ROS_HOSTNAME=localhost MPLCONFIGDIR="$work/robot" bash -c '
    [ ! -f /opt/ros/noetic/setup.bash ] || . /opt/ros/noetic/setup.bash
    . "$1/setup.bash" && shift && "$@"' bash "$moved" "$@"
}
for binary in "$moved"/lib/*.so "$moved"/lib/semantic_vslam/*; do
  if ldd "$binary" 2>/dev/null | grep -E "not found|$build|/\.cache/"; then echo "outside_package.sh: FAILED: $binary"; exit 1; fi
done
if [ "$(cached CMAKE_DISABLE_FIND_PACKAGE_ONNXRuntime)" != ON ]; then
  python3 -c 'import cv2, numpy, sys; cv2.imwrite(sys.argv[1], numpy.full((96, 128, 3), 90, numpy.uint8))' "$work/images/gray.png"
  for kind in onnx yaml; do cp "$moved"/share/semantic_vslam/models/{bisenetv2_indoor,only_here}.$kind; done
  quietly on_robot "$moved/lib/semantic_vslam/label_images" only_here.onnx "$work/images" "$work/labels"
fi
quietly on_robot rostest "$repository/test/ros/nodelets.test"
echo "outside_package.sh: ok: moved install space"

# The core by itself. Where there is a compiler cache, it has all that this compiles; else configuring must do.
alone=$(dirname "$build")/core
options+=("-DONNXRUNTIME_ROOT=$(cached ONNXRUNTIME_ROOT)" "-DSEMANTIC_VSLAM_WARNINGS_AS_ERRORS=$(cached SEMANTIC_VSLAM_WARNINGS_AS_ERRORS)")
quietly cmake -S "$repository/src/core" -B "$alone" -G Ninja "${options[@]}" -DCMAKE_DISABLE_FIND_PACKAGE_catkin=ON
if command -v ccache >/dev/null; then quietly cmake --build "$alone"; fi
echo "outside_package.sh: ok: core by itself"

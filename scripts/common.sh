# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Sourced by ./run and its scripts, which set root to the repository: messages, and the environment that a build and the ROS programs need.

say() { echo "[run] $*" >&2; }

# One line: what failed, and what to do about it.
die() {
  echo "[run] FAILED: $*" >&2
  exit 1
}

# "debian11", "debian12", "debian13", "noetic" (Ubuntu 20.04) or "other"
system_name() {
  local id version
  id=$(. /etc/os-release && echo "$ID")
  version=$(. /etc/os-release && echo "${VERSION_ID:-}")
  case $id-$version in
    debian-11 | debian-12 | debian-13) echo "debian$version" ;;
    ubuntu-20.04) echo noetic ;;
    *) echo other ;;
  esac
}

# Where downloads are kept between builds and clones.
cache_dir() {
  local dir=${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}/semantic_vslam
  if ! mkdir -p "$dir" 2>/dev/null || [ ! -w "$dir" ]; then
    dir=${root:?}/build/cache
    mkdir -p "$dir"
  fi
  echo "$dir"
}

# usage: use_system_environment BUILD_DIR. A python3 that is not the system's, first in PATH, breaks catkin: hence the short PATH.
use_system_environment() {
  export PATH=/usr/sbin:/usr/bin:/sbin:/bin ROS_HOSTNAME=localhost ROS_HOME=$1/.ros
  unset PYTHONPATH PYTHONHOME VIRTUAL_ENV CMAKE_PREFIX_PATH ROS_PACKAGE_PATH
  [ ! -f /opt/ros/noetic/setup.bash ] || source_setup /opt/ros/noetic/setup.bash
}

# usage: source_setup FILE   catkin's generated files read variables that may be unset
source_setup() {
  set +u
  # shellcheck disable=SC1090
  . "$1"
  set -u
}

# JOBS, or one compiler a core as far as memory allows (2 GB each).
parallel_jobs() {
  local by_memory
  by_memory=$(awk '/MemAvailable/ { n = int($2 / 2000000); print (n < 1 ? 1 : n) }' /proc/meminfo)
  echo "${JOBS:-$(($(nproc) < by_memory ? $(nproc) : by_memory))}"
}

#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Prints the prefix of ONNX Runtime (include/ and lib/): ONNXRUNTIME_ROOT if set, else a system copy, else the
# cached one, which is downloaded first if need be. Older systems do not package it for C++, so it is put together from
#   headers: Debian 13's libonnxruntime-dev, unpacked, never installed, from the Debian mirror this machine is set up with;
#   library: the Python wheel of the same version (they must match: symbols are versioned), by pip.
# Prints nothing where there is none to be had (a system without a Debian mirror, another processor) or ONNXRUNTIME_ROOT=none: the
# build goes on without segmentation.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/scripts/common.sh"

version=1.21.0
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
headers_version=$version+dfsg-1
headers_sha256=14f7d959d5deacbcf1504830d4189f91fc67382b399ed9ae9d3aa9c4050ced08
machine=$(uname -m)
case $machine in
  x86_64) wheel_sha256=8a5d09815a9e209fa0cb20c2985b34ab4daeba7aea94d0f96b8751eb10403201 ;;
  aarch64) wheel_sha256=7f9156cf6f8ee133d07a751e6518cf6f84ed37fbf8243156bd4a2c4ee6e073c8 ;;
  *) wheel_sha256='' ;;
esac
advice="get ONNX Runtime $version (include/ and lib/; releases of microsoft/onnxruntime have them) and set ONNXRUNTIME_ROOT to its
folder, or ONNXRUNTIME_ROOT=none to build without segmentation"

# usage: is_complete PREFIX
is_complete() {
  { [ -f "$1/include/onnxruntime_cxx_api.h" ] || [ -f "$1/include/onnxruntime/onnxruntime_cxx_api.h" ]; } &&
    { compgen -G "$1/lib*/libonnxruntime.so" || compgen -G "$1/lib/*/libonnxruntime.so"; } >/dev/null
}

if [ "${ONNXRUNTIME_ROOT:-}" = none ]; then
  say "building without segmentation, as ONNXRUNTIME_ROOT=none says"
  exit 0
fi
if [ -n "${ONNXRUNTIME_ROOT:-}" ]; then
  is_complete "$ONNXRUNTIME_ROOT" || die "ONNXRUNTIME_ROOT=$ONNXRUNTIME_ROOT lacks onnxruntime_cxx_api.h or libonnxruntime.so"
  echo "$ONNXRUNTIME_ROOT"
  exit 0
fi
prefix=$(cache_dir)/onnxruntime-$version
# Debian 13's own writes 1135 lines about its operators at every start: it registers those that libonnx has registered.
# usage: registers_twice PREFIX
registers_twice() { ldd "$1"/lib/*/libonnxruntime.so 2>/dev/null | grep -q 'libonnx\.so'; }

for candidate in /usr /usr/local "$prefix"; do
  if is_complete "$candidate" && ! registers_twice "$candidate"; then
    echo "$candidate"
    exit 0
  fi
done

# usage: do_without WHY
do_without() {
  say "building WITHOUT segmentation: $1. To have it, $advice"
  exit 0
}
[ -n "$wheel_sha256" ] || do_without "no ONNX Runtime is pinned for $machine"
[ -f "$keyring" ] || do_without "this system has no Debian mirror to take ONNX Runtime's headers from"
say "fetching ONNX Runtime $version into $prefix (16 MB)"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{lists,cache/archives,headers,prefix/include,prefix/lib}/partial
rmdir "$work"/{headers,prefix/include,prefix/lib}/partial

# A private apt: its own lists and cache, no effect on the system's.
# usage: write_apt_conf FILE [SOURCE_LIST]   (without SOURCE_LIST: the system's sources)
write_apt_conf() {
  cat >"$1" <<CONF
Dir::State::lists "$work/lists"; Dir::Cache "$work/cache"; APT::Sandbox::User "root";
Acquire::Languages "none"; Acquire::IndexTargets::deb::DEP-11::DefaultEnabled "false";
CONF
  [ -z "${2:-}" ] || echo "Dir::Etc::sourcelist \"$2\"; Dir::Etc::sourceparts \"-\";" >>"$1"
}

# The mirror that serves Debian's main archive to this machine.
debian_mirror() {
  apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' 2>/dev/null | head -n 1
}

get_headers() {
  local mirror
  mirror=$(debian_mirror)
  if [ -z "$mirror" ]; then  # package lists were never fetched, or were cleaned away
    write_apt_conf "$work/system.conf"
    mirror=$(export APT_CONFIG="$work/system.conf" && apt-get -qq update && debian_mirror) || true
  fi
  if [ -z "$mirror" ]; then
    die "no Debian mirror in the apt sources to take ONNX Runtime's headers from; $advice"
  fi
  echo "deb [signed-by=$keyring] $mirror trixie main" >"$work/sources.list"
  write_apt_conf "$work/trixie.conf" "$work/sources.list"
  echo 'APT::Architecture "amd64"; APT::Architectures { "amd64"; };' >>"$work/trixie.conf"  # headers are the same for all
  (
    cd "$work/headers"
    export APT_CONFIG=$work/trixie.conf
    apt-get -qq update && apt-get -qq download "libonnxruntime-dev=$headers_version"
  ) >&2 || die "could not download libonnxruntime-dev $headers_version from $mirror; check the network, or $advice"
  echo "$headers_sha256  $(echo "$work"/headers/*.deb)" | sha256sum --quiet --check - >&2 ||
    die "the checksum of libonnxruntime-dev $headers_version is not the pinned one; $advice"
  dpkg-deb -x "$work"/headers/*.deb "$work/headers/unpacked"
  cp -r "$work/headers/unpacked/usr/include/onnxruntime/." "$work/prefix/include/"
}

get_library() {
  echo "onnxruntime==$version --hash=sha256:$wheel_sha256" >"$work/wheel.txt"
  python3 -m pip -q download --no-deps --require-hashes --only-binary=:all: --python-version 311 --implementation cp \
    --platform "manylinux_2_28_$machine" --platform "manylinux_2_27_$machine" -d "$work" -r "$work/wheel.txt" >&2 ||
    die "could not download the onnxruntime $version wheel with the pinned checksum by pip (message above); check the network, or $advice"
  python3 -m zipfile -e "$work"/onnxruntime-$version-*.whl "$work/wheel"
  cp "$work/wheel/onnxruntime/capi/libonnxruntime.so.$version" "$work/prefix/lib/"
  ln -s "libonnxruntime.so.$version" "$work/prefix/lib/libonnxruntime.so.1"
  ln -s libonnxruntime.so.1 "$work/prefix/lib/libonnxruntime.so"
}

get_headers
get_library
is_complete "$work/prefix" || die "the downloaded ONNX Runtime is incomplete; $advice"
rm -rf "$prefix.new" && cp -r "$work/prefix" "$prefix.new" && rm -rf "$prefix" && mv "$prefix.new" "$prefix"
echo "$prefix"

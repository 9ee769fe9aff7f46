#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# README's two commands on a bare system of another Debian suite, as before a release: debootstrap makes it, the last commit
# (nothing that is not committed) is cloned into it, and what is missing installs itself. Needs root and debootstrap, 4 GB of disk
# and, for both commands, about half an hour of two cores.
#   scripts/try_in_chroot.sh bullseye|bookworm|trixie [COMMAND...]       default: './run demo' './run test'
# Leaves the log in out/chroot/SUITE.log and the system in /var/tmp/semantic_vslam/SUITE, where ROS does not look for packages; it is
# made anew each time, but with KEEP=1, which keeps what was installed and the compiler's cache.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/scripts/common.sh"
suite=${1:?usage: scripts/try_in_chroot.sh SUITE [COMMAND...]}
shift
[ $# -gt 0 ] || set -- './run demo' './run test'
[ "$(id -u)" = 0 ] || die "a chroot needs root; run it with sudo"
command -v debootstrap >/dev/null || die "debootstrap is missing; run: apt-get install debootstrap"

system=/var/tmp/semantic_vslam/$suite
log=$root/out/chroot/$suite.log
mkdir -p "$(dirname "$log")" "$(dirname "$system")"
: >"$log"

release() { for place in dev/pts dev/shm dev sys proc; do umount "$system/$place" 2>/dev/null || true; done; }
trap release EXIT
release

if [ -z "${KEEP:-}" ]; then
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' | head -n 1)
  [ -n "$mirror" ] || die "no Debian mirror in the apt sources of this machine"
  say "making a bare $suite in $system"
  rm -rf --one-file-system "$system"
  debootstrap --variant=minbase --include=ca-certificates,git "$suite" "$system" "$mirror" >>"$log" 2>&1 ||
    die "debootstrap (see ${log#"$root/"})"
fi
# The way to the network is this machine's.
for file in etc/resolv.conf etc/hosts etc/ssl/certs/ca-certificates.crt; do
  [ ! -e "/$file" ] || cp -L "/$file" "$system/$file"
done
cp -r /etc/apt/apt.conf.d/*proxy* "$system/etc/apt/apt.conf.d/" 2>/dev/null || true
mount -t proc proc "$system/proc"
mount -t sysfs sys "$system/sys"
mount --bind /dev "$system/dev"
mount --bind /dev/pts "$system/dev/pts"
mount -t tmpfs shm "$system/dev/shm"

rm -rf "$system/root/semantic_vslam"
mkdir -p "$system/root/home"
git -c safe.directory='*' clone -q --no-hardlinks "$root" "$system/root/semantic_vslam"
passed=()
for name in PIP_CERT PIP_INDEX_URL PIP_EXTRA_INDEX_URL PIP_DEFAULT_TIMEOUT http_proxy https_proxy no_proxy JOBS; do
  [ -z "${!name:-}" ] || passed+=("$name=${!name}")
done
for command in "$@"; do
  say "$suite: $command"
  start=$SECONDS
  chroot "$system" env -i HOME=/root/home LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin "${passed[@]}" \
    bash -c "cd /root/semantic_vslam && $command" >>"$log" 2>&1 || die "$suite: $command, after $((SECONDS - start)) s (see ${log#"$root/"})"
  say "$suite: $command: passed in $((SECONDS - start)) s"
done

#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages of packages.txt that are missing. usage: install_dependencies.sh build|demo|lint
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/scripts/common.sh"
purpose=${1:?usage: install_dependencies.sh build|demo|lint}

# usage: wanted COLUMN   names of the packages for this purpose
wanted() {
  awk -v column="$1" -v purpose="$purpose" '
    !/^#/ && NF && ($1 == "build" || $1 == purpose) && $column != "-" { print $column }
  ' "$root/scripts/packages.txt" | sort -u
}

case $(system_name) in
  debian*) column=2 ;;
  noetic) column=3 ;;
  *)
    [ -z "${SKIP_PACKAGES:-}" ] || exit 0
    die "this system is none of Debian 11, 12, 13 and Ubuntu 20.04. Install what these packages of Debian hold, then run with
SKIP_PACKAGES=1: $(wanted 2 | tr '\n' ' ')"
    ;;
esac

wanted=$(wanted $column)
installed() { dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p' | sort -u; }
missing() { comm -23 <(echo "$wanted") <(installed); }

[ -n "$(missing)" ] || exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || die "packages are missing and there is no sudo; as root run: apt-get install -y $(missing | tr '\n' ' ')"
  as_root=(sudo)
  say "$(missing | wc -l) packages are missing; they are installed with sudo apt-get, which may ask for your password"
fi

# One apt at a time: ours wait here for each other, and DPkg::Lock::Timeout waits for anyone else's.
exec 9>"$(cache_dir)/apt.lock"
flock 9
mapfile -t packages < <(missing)
[ ${#packages[@]} -gt 0 ] || exit 0
apt_get=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600 -o Dpkg::Use-Pty=0)
say "installing ${#packages[@]} packages and what they depend on (a few minutes)"
"${apt_get[@]}" update 9>&- || say "apt-get update had errors; trying with the package lists there are"
unknown=$(comm -23 <(printf '%s\n' "${packages[@]}") <(apt-cache pkgnames | sort -u) | tr '\n' ' ')
[ -z "$unknown" ] ||
  die "not in the configured package sources: ${unknown}(add $([ $column = 3 ] && echo "the ROS Noetic source" || echo "Debian's main archive") and run again)"
"${apt_get[@]}" install -y --no-install-recommends "${packages[@]}" 9>&- ||
  die "apt-get install (messages above); mend it, for instance with: apt-get -f install, then run again"

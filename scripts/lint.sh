#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Format and static checks; changes nothing. usage: ./run lint [--tidy]
# --tidy adds clang-tidy on the C++ files that differ from the main branch (slow). Tools that are not installed are named and skipped.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/scripts/common.sh"
cd "$root"
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
failed=()

# usage: check TOOL NAME COMMAND...   runs COMMAND if TOOL is installed, and goes on after a failure
check() {
  local tool=$1 name=$2
  shift 2
  if ! command -v "$tool" >/dev/null; then
    say "skipped: $name ($tool is not installed)"
  elif "$@"; then
    say "ok: $name"
  else
    failed+=("$name")
  fi
}

cpp_files() { find src include test \( -name '*.cpp' -o -name '*.h' \) -print0 2>/dev/null; }
check_format() { cpp_files | xargs -0 -r clang-format --dry-run -Werror; }
check_shell() { shellcheck --external-sources --severity=warning run .ci/run scripts/*.sh test/*.sh; }
# usage: tracked PATTERN...   the repository's files of these names, without what was built, zero-terminated
tracked() { find . \( -path ./build -o -path ./out -o -path ./.git \) -prune -o -type f \( "$@" \) -print0; }
check_python() {
  tracked -name '*.py' | xargs -0 -r python3 -c 'import ast, sys
for name in sys.argv[1:]: ast.parse(open(name).read(), name)'
}
check_xml() {
  tracked -name '*.xml' -o -name '*.launch' -o -name '*.test' | xargs -0 python3 -c 'import sys, xml.dom.minidom
for name in sys.argv[1:]:
    try: xml.dom.minidom.parse(name)
    except Exception as error: sys.exit(f"{name}: {error}")'
}
# Not asked for: include folders of whole directories (ours are per target), a library by the name catkin wants (the extras file
# brings semantic_vslam::core with all that it needs), one project (the core is built alone, and octomap_msgs stands in where a
# system lacks it), and scripts for the repository alone in the install space, or those that launch files name by path elsewhere.
check_catkin() {
  catkin_lint --strict -q . --ignore unused_catkin_include_dirs --ignore unused_include_path --ignore uninstalled_include_path \
    --ignore missing_export_lib --ignore subproject --ignore uninstalled_script --ignore wrong_bin_install_destination
}
check_license() {
  local unsigned
  unsigned=$(find src include test scripts -type f \( -name '*.cpp' -o -name '*.h' -o -name '*.py' -o -name '*.sh' \) \
    -exec sh -c 'head -n 3 "$1" | grep -q "SPDX-License-Identifier: BSD-3-Clause" || echo "$1: no SPDX header"' sh {} \;)
  [ -z "$unsigned" ] || { echo "$unsigned"; return 1; }
}
check_headers() {
  ninja -C build/release check_headers >build/release/check_headers.log 2>&1 || { grep -A5 'error:' build/release/check_headers.log; return 1; }
}
check_tidy() {
  local base changed
  base=$(git merge-base HEAD "$(git rev-parse --verify -q origin/main || git rev-parse main)")
  mapfile -t changed < <(git diff --name-only --diff-filter=d "$base" -- 'src/*.cpp')
  [ ${#changed[@]} -eq 0 ] || clang-tidy --quiet -p build/release "${changed[@]}"
}

check clang-format "format (clang-format)" check_format
check grep "licence headers" check_license
check sh "core free of ROS" test/core_is_ros_free.sh "$root"
check python3 "order of the core's folders" python3 test/core_floors.py "$root"
check shellcheck "shell scripts" check_shell
check python3 "Python syntax" check_python
check python3 "XML files" check_xml
check catkin_lint "catkin package" check_catkin
if [ -f build/release/build.ninja ]; then
  check ninja "self-contained headers" check_headers
else
  say "skipped: self-contained headers (needs ./run build)"
fi
if [ "${1:-}" = --tidy ]; then
  [ -f build/release/compile_commands.json ] || die "clang-tidy needs the build's compile commands; run ./run build first"
  check clang-tidy "clang-tidy on changed files" check_tidy
fi

[ ${#failed[@]} -eq 0 ] || die "lint: $(IFS=,; echo "${failed[*]}"); the messages are above (format: clang-format -i FILE)"

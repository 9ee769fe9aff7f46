#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Before a release: whether rosdep and bloom know every key of package.xml, for Noetic on Ubuntu focal, and for Debian.

usage: scripts/check_rosdep_keys.py ROSDISTRO     a checkout of ros/rosdistro
"""
import os
import sys
import xml.etree.ElementTree

import yaml

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
KINDS = ("depend", "build_depend", "exec_depend", "test_depend", "buildtool_depend")
SYSTEMS = (("ubuntu", "focal"), ("debian", "bullseye"), ("debian", "bookworm"))


def keys_of(package_xml):
    root = xml.etree.ElementTree.parse(package_xml).getroot()
    return sorted({element.text for kind in KINDS for element in root.findall(kind)})


def ros_packages(rosdistro):
    """@return {package, ...} released in Noetic"""
    with open(os.path.join(rosdistro, "noetic", "distribution.yaml")) as file:
        repositories = yaml.load(file, yaml.CSafeLoader)["repositories"]
    names = set()
    for name, repository in repositories.items():
        release = repository.get("release", {})
        names.update(release.get("packages", [name]) if release.get("version") else [])
    return names


def system_packages(rosdistro):
    """@return {key: {system: {version or name: package}}}"""
    rules = {}
    for name in ("base.yaml", "python.yaml"):
        with open(os.path.join(rosdistro, "rosdep", name)) as file:
            rules.update(yaml.load(file, yaml.CSafeLoader))
    return rules


def is_resolved(rule, version):
    """@param rule  what rosdep has for a system: names, or {version: names, "*": names}, where null means none"""
    if isinstance(rule, dict) and not set(rule) & {"apt", "packages"}:
        return bool(rule.get(version, rule.get("*")))
    return bool(rule)


def problems(keys, released, rules):
    for key in keys:
        if key in released:
            continue
        if key not in rules:
            yield f"{key}: neither a package of Noetic nor a key of rosdep"
            continue
        for system, version in SYSTEMS:
            if not is_resolved(rules[key].get(system), version):
                yield f"{key}: nothing for {system} {version}"


def main(arguments):
    if len(arguments) != 1 or not os.path.isdir(os.path.join(arguments[0], "rosdep")):
        sys.exit(__doc__)
    keys = keys_of(os.path.join(ROOT, "package.xml"))
    found = list(problems(keys, ros_packages(arguments[0]), system_packages(arguments[0])))
    for problem in found:
        print(problem)
    print(f"{len(keys)} keys, {len(found)} problems")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of parameters in doc/nodes.md are what the programs list (--list-config).

usage, with the devel space's environment: node_parameters_test.py [--write]   --write puts the tables in.
"""
import os
import re
import subprocess
import sys
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.append(os.path.join(ROOT, "test", "ros"))
from programs import program, skip_without_programs

PAGE = os.path.join(ROOT, "doc", "nodes.md")
NODES = ("motion", "segmentation", "tracking", "mapping")
UNITS = {"m": "m", "m2": "m2", "s": "s", "ms": "ms", "px": "px", "mb": "MiB", "deg": "deg", "rad": "rad", "mps2": "m/s2"}
BLOCK = r"<!-- parameters: {} -->\n(.*?)<!-- end -->"
BOUNDS = r"\[[^\]]*\]|[\w.]+(?:\|[\w.]+)+"


def listed(name):
    """@return {key: (default, bounds, meaning)}, as the program lists them"""
    out = subprocess.run([program(name), "--list-config"], capture_output=True, text=True, timeout=60, check=True).stdout
    rows = {}
    for line in out.splitlines():
        key, default, rest = re.fullmatch(r"(\S+) +(\S+) *(.*)", line).groups()
        bounds, meaning = re.fullmatch(rf"({BOUNDS})?\s*(.*)", rest).groups()
        rows[key] = (default, bounds or "", meaning)
    return rows


def unit(key, meaning):
    """By the end of a part of the name, or the first word of the meaning."""
    for part in reversed(key.split(".")):
        ending = part.rpartition("_")[2]
        if ending in UNITS and ending != part:
            return UNITS[ending]
    first = re.match(r"(m|rad|s|ms)(?=[ ,;]|$)", meaning)
    return first[1] if first else ""


def table(rows, separator):
    """A parameter of a node has slashes."""
    lines = ["| parameter | default | unit | bounds | what |", "|---|---|---|---|---|"]
    for key, (default, bounds, meaning) in rows.items():
        cells = (f"`{key.replace('.', separator)}`", f"`{default}`", unit(key, meaning), bounds.replace("|", ", "), meaning.replace("|", "\\|"))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def groups(keys):
    return list(dict.fromkeys(key.split(".")[0] for key in keys))


def tables():
    """@return {name of a block: its text}"""
    method = listed("run_offline")
    blocks = {}
    for node in NODES:
        rows = listed(node + "_node")
        own = {key: row for key, row in rows.items() if key not in method}
        shared = ", ".join(f"`{group}`" for group in groups(key for key in rows if key in method))
        blocks[node] = f"{table(own, '/')}\nAnd of the [parameters of the method](#parameters-of-the-method): {shared}.\n"
    blocks["method"] = table(method, ".")
    return blocks


def read_page():
    with open(PAGE, encoding="utf-8") as file:
        return file.read()


class NodeParameters(unittest.TestCase):
    def test_page_has_what_the_programs_list(self):
        skip_without_programs()
        page = read_page()
        for name, text in tables().items():
            with self.subTest(name):
                written = re.search(BLOCK.format(name), page, re.S)
                self.assertIsNotNone(written, f"doc/nodes.md has no block '{name}'")
                self.assertEqual(written[1].splitlines(), text.splitlines(), "test/python/node_parameters_test.py --write")


def write():
    page = read_page()
    for name, text in tables().items():
        page = re.sub(rf"(<!-- parameters: {name} -->\n).*?(<!-- end -->)", lambda found: found[1] + text + found[2], page, flags=re.S)
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(page)


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        write()
    else:
        unittest.main()

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps the order of the core's folders: fails, naming the line, where a file breaks one of the rules below.

usage: core_floors.py REPOSITORY
"""
import glob
import os
import re
import sys

# 1. A folder includes only itself and folders on floors below it, never a neighbour on its own floor: no circles then.
FLOORS = [
    ["common"],
    ["geometry"],
    ["camera"],
    ["io", "features", "labels"],
    ["map"],
    ["optimization"],
    ["motion", "segmentation", "tracking", "loop", "mapping", "dense", "people"],
    ["pipeline"],
    ["runtime"],
]
# 2. The core knows neither eval nor the ROS side; eval does not know the ROS side.
# 3. Public headers, those in include/, include public ones only: the others are not installed.
# 4. Threads and locks stand in runtime only.
THREADS = re.compile(r"std::(thread|jthread|mutex|shared_mutex|recursive_mutex|timed_mutex|lock_guard|unique_lock|"
                     r"scoped_lock|shared_lock|condition_variable\w*|atomic\w*|async|future|promise|once_flag|call_once)"
                     r"\b")
# 5. A header of src/ros must not be named like one of roscpp's, which would be found in its place.
ROS_HEADERS = ["/usr/include/ros", "/opt/ros/noetic/include/ros"]

# Files that may use them for good, and why.
ALLOWED_THREADS = {
    "src/core/common/log.cpp": "the process has one sink, which any thread may write to",
    "include/semantic_vslam/core/common/stage_timing.h": "stages on several threads enter their times",
    "src/core/common/stage_timing.cpp": "the same",
    "src/core/common/atomic_file.cpp": "names of temporary files differ between threads",
    "src/core/common/abort_flag.h": "a solver looks at it between steps, another thread may set it",
}


class Checker:
    def __init__(self, root):
        self.root = root
        self.failures = []
        self.floor = {folder: i for i, folders in enumerate(FLOORS) for folder in folders}

    def fail(self, path, line, message):
        self.failures.append(f"{path}:{line}: {message}")

    def check_include(self, path, line, folder, name):
        match = re.match(r"(semantic_vslam/)?(core|eval|ros)/(?:(\w+)/)?", name)
        if not match:
            return
        public, side, other = match.groups()
        if not any(os.path.exists(os.path.join(self.root, place, name)) for place in ("include", "src")):
            return  # a header of ROS
        if side == "ros" or (side == "eval" and folder):
            self.fail(path, line, f"includes {name}, of a side that it must not know")
        elif folder and side == "core" and other != folder and self.floor.get(other, 0) >= self.floor.get(folder, 0):
            self.fail(path, line, f"{folder} (floor {self.floor.get(folder)}) includes {name} "
                      f"(floor {self.floor.get(other)})")
        if path.startswith("include/") and not public:
            self.fail(path, line, f"a public header includes {name}, which is private")

    def check_file(self, path):
        match = re.match(r"(?:src|include/semantic_vslam)/(core|eval)/(?:(\w+)/)?", path)
        folder = match.group(2) if match.group(1) == "core" else None
        if match.group(1) == "core" and folder not in self.floor:
            self.failures.append(f"{path}: {folder} has no floor: give it one in {os.path.basename(__file__)}")
            return
        with open(os.path.join(self.root, path), encoding="utf-8") as file:
            for line, text in enumerate(file, 1):
                include = re.match(r'\s*#\s*include\s*"([^"]+)"', text)
                if include:
                    self.check_include(path, line, folder, include.group(1))
                elif folder and folder != "runtime" and path not in ALLOWED_THREADS:
                    threads = THREADS.search(text.split("//")[0])
                    if threads:
                        self.fail(path, line, f"{threads.group()} outside src/core/runtime")

    def check_names(self):
        for header in glob.glob(os.path.join(self.root, "src/ros/*.h")):
            name = os.path.basename(header)
            if any(os.path.exists(os.path.join(folder, name)) for folder in ROS_HEADERS):
                self.failures.append(f"src/ros/{name}: hides ROS's own ros/{name}")

    def run(self):
        for top in ("src/core", "src/eval", "include/semantic_vslam"):
            for folder, _, names in sorted(os.walk(os.path.join(self.root, top))):
                for name in sorted(names):
                    if name.endswith((".h", ".cpp")):
                        self.check_file(os.path.relpath(os.path.join(folder, name), self.root))
        self.check_names()
        return self.failures


def main():
    failures = Checker(sys.argv[1]).run()
    if failures:
        print("\n".join(failures))
        sys.exit(f"{len(failures)} lines break the order of the core's folders; the rules stand in {__file__}")


if __name__ == "__main__":
    main()

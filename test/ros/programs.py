# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the package's programs are, for every rostest."""
import os
import threading
import unittest

# Debian 11's rospy asks for this at the end of a program; Python 3.9 no longer has it, and the test's result is lost.
if not hasattr(threading.Thread, "isAlive"):
    threading.Thread.isAlive = threading.Thread.is_alive


def program(name):
    """@return path of a program of this package. rosrun finds none where the build folder lies inside the package."""
    for folder in os.environ["CMAKE_PREFIX_PATH"].split(":"):
        path = os.path.join(folder, "lib", "semantic_vslam", name)
        if os.access(path, os.X_OK):
            return path
    raise FileNotFoundError(f"{name} is in no folder of CMAKE_PREFIX_PATH; was it built, and setup.bash sourced?")


def skip_without_programs():
    """For tests that are no rostests, and may be run without a build."""
    try:
        program("run_offline")
    except (KeyError, FileNotFoundError) as error:
        raise unittest.SkipTest(f"no programs: {error}; run by ctest, or source devel/setup.bash")

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the package's programs are."""
import os


def program(name):
    """@return path of a program of this package. rosrun finds none where the build folder lies inside the package."""
    for folder in os.environ["CMAKE_PREFIX_PATH"].split(":"):
        path = os.path.join(folder, "lib", "semantic_vslam", name)
        if os.access(path, os.X_OK):
            return path
    raise FileNotFoundError(f"{name} is in no folder of CMAKE_PREFIX_PATH; was it built, and setup.bash sourced?")

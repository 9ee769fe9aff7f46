# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Of find_package(catkin COMPONENTS semantic_vslam): the core with what it needs to be linked, which a list of libraries
# cannot say.
find_package(semantic_vslam_core REQUIRED CONFIG HINTS ${semantic_vslam_DIR}/../../../lib/cmake/semantic_vslam_core)
list(APPEND semantic_vslam_LIBRARIES semantic_vslam::core)

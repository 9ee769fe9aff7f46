# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Finds the libraries of the core: for its own build, for the catkin package's and, installed beside the package config,
# for everything that links it.
include_guard(DIRECTORY)
find_package(Eigen3 REQUIRED)
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d video flann)
find_package(Ceres REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(octomap REQUIRED)
find_package(Threads REQUIRED)
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})
if(NOT TARGET ONNXRuntime::ONNXRuntime)
  find_package(ONNXRuntime)  # without it no network runs
endif()

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# How everything here is compiled, for the catkin package and for the core by itself.
include_guard(DIRECTORY)
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo" FORCE)
endif()

set(SEMANTIC_VSLAM_SANITIZE "" CACHE STRING "thread or address: instrument everything, for the core tests")
if(SEMANTIC_VSLAM_SANITIZE)
  add_compile_options(-fsanitize=${SEMANTIC_VSLAM_SANITIZE} -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${SEMANTIC_VSLAM_SANITIZE})
endif()

add_compile_options(-Wall -Wextra)
option(SEMANTIC_VSLAM_WARNINGS_AS_ERRORS "a warning stops the build; ./run sets it under CI=true" OFF)
if(SEMANTIC_VSLAM_WARNINGS_AS_ERRORS AND NOT SEMANTIC_VSLAM_SANITIZE)  # of instrumented code compilers warn falsely
  add_compile_options(-Werror)
endif()

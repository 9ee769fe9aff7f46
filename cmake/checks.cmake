# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# Target check_headers: compiles every header of core and eval by itself, so that each includes what it uses. Run by ./run lint.
file(GLOB_RECURSE public_headers RELATIVE ${PROJECT_SOURCE_DIR}/include CONFIGURE_DEPENDS include/semantic_vslam/*.h)
file(GLOB_RECURSE private_headers RELATIVE ${PROJECT_SOURCE_DIR}/src CONFIGURE_DEPENDS src/core/*.h src/eval/*.h)
set(header_sources)
foreach(header ${public_headers} ${private_headers})
  set(header_source ${PROJECT_BINARY_DIR}/check_headers/${header}.cpp)
  if(NOT EXISTS ${header_source})
    file(WRITE ${header_source} "#include \"${header}\"\n")
  endif()
  list(APPEND header_sources ${header_source})
endforeach()
add_library(check_headers OBJECT EXCLUDE_FROM_ALL ${header_sources})
target_link_libraries(check_headers PRIVATE semantic_vslam_core ${CERES_LIBRARIES} ${OCTOMAP_LIBRARIES})

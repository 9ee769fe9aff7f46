# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# ONNX Runtime: target ONNXRuntime::ONNXRuntime. Debian 13 packages it (libonnxruntime-dev), older systems do not: ./run
# fetches it into the cache named here.
set(ONNXRUNTIME_ROOT "$ENV{ONNXRUNTIME_ROOT}" CACHE PATH "prefix that holds include/onnxruntime_cxx_api.h and lib/libonnxruntime.so")
set(onnxruntime_hints ${ONNXRUNTIME_ROOT} ${ONNXRUNTIME_BUILT_WITH} $ENV{XDG_CACHE_HOME}/semantic_vslam/onnxruntime-1.21.0
                      $ENV{HOME}/.cache/semantic_vslam/onnxruntime-1.21.0)
find_path(ONNXRUNTIME_INCLUDE_DIR onnxruntime_cxx_api.h HINTS ${onnxruntime_hints} PATH_SUFFIXES include include/onnxruntime)
find_library(ONNXRUNTIME_LIBRARY onnxruntime HINTS ${onnxruntime_hints} PATH_SUFFIXES lib)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ONNXRuntime REQUIRED_VARS ONNXRUNTIME_LIBRARY ONNXRUNTIME_INCLUDE_DIR
    REASON_FAILURE_MESSAGE "run ./run build once, or pass -DONNXRUNTIME_ROOT=<prefix>")
if(ONNXRuntime_FOUND AND NOT TARGET ONNXRuntime::ONNXRuntime)
  add_library(ONNXRuntime::ONNXRuntime UNKNOWN IMPORTED)
  set_target_properties(ONNXRuntime::ONNXRuntime PROPERTIES
      IMPORTED_LOCATION ${ONNXRUNTIME_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${ONNXRUNTIME_INCLUDE_DIR})
endif()

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
# octomap_msgs: the distribution's package, or one of this or an underlying workspace; where there is none (Debian 12),
# compat/octomap_msgs is built along, so that a plain cmake, catkin_make and catkin build all find the message.
# What an earlier run of this very build left in its own devel space does not count as found.
set(octomap_msgs_stand_in TRUE)
if(TARGET octomap_msgs_generate_messages)
  set(octomap_msgs_stand_in FALSE)
endif()
foreach(prefix ${CMAKE_PREFIX_PATH} /usr)
  set(config ${prefix}/share/octomap_msgs/cmake/octomap_msgsConfig.cmake)
  if(EXISTS ${config})
    get_filename_component(config ${config} REALPATH)
    get_filename_component(devel_prefix ${CATKIN_DEVEL_PREFIX} REALPATH)
    string(FIND ${config} ${devel_prefix}/ position)
    if(NOT position EQUAL 0)
      set(octomap_msgs_stand_in FALSE)
    endif()
  endif()
endforeach()

if(octomap_msgs_stand_in)
  message(STATUS "octomap_msgs is not installed: building the stand-in in compat/octomap_msgs")
  add_subdirectory(compat/octomap_msgs)
  # The marker file lists the devel space's sources; with the stand-in on it, rospack and rosmsg find the package too.
  file(READ ${CATKIN_DEVEL_PREFIX}/.catkin source_spaces)
  set(stand_in_dir ${PROJECT_SOURCE_DIR}/compat/octomap_msgs)
  if(NOT stand_in_dir IN_LIST source_spaces)
    file(APPEND ${CATKIN_DEVEL_PREFIX}/.catkin ";${stand_in_dir}")
  endif()
endif()

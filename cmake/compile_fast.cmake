# SPDX-License-Identifier: BSD-3-Clause
# Most of the time to compile the core goes into reading Eigen's and OpenCV's headers: they are read once.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON goes without, and shows which file does not include what it uses.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_CURRENT_LIST_DIR}/compile_cached ${CCACHE_PROGRAM})
endif()

# What most sources include anyway.
set(POSEFUSION_COMMON_HEADERS
  <algorithm> <functional> <memory> <optional> <sstream> <string> <unordered_map> <vector>
  <Eigen/Cholesky> <Eigen/Geometry> <opencv2/core.hpp>)
set(POSEFUSION_ROS_HEADERS
  ${POSEFUSION_COMMON_HEADERS} <ros/ros.h> <sensor_msgs/Image.h> <sensor_msgs/CameraInfo.h>)

# Precompiles headers in the first target of a kind; the others of that kind take them from it.
function(posefusion_share_headers target kind)
  get_property(owner GLOBAL PROPERTY posefusion_headers_of_${kind})
  if(owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
    return()
  endif()
  set_property(GLOBAL PROPERTY posefusion_headers_of_${kind} ${target})
  target_precompile_headers(${target} PRIVATE ${ARGN})
endfunction()

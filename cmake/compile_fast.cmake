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

option(POSEFUSION_TOGETHER "Compile some sources of a folder at once; OFF: each by itself" ON)

# Compiles six sources of a folder at once: what they all include and instantiate is compiled once then. So names in the
# unnamed namespaces of a folder differ from each other.
function(posefusion_compile_together target)
  if(NOT POSEFUSION_TOGETHER OR CMAKE_VERSION VERSION_LESS 3.18)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    get_filename_component(path ${source} ABSOLUTE)
    get_filename_component(folder ${path} DIRECTORY)
    get_filename_component(name ${folder} NAME)
    if(NOT DEFINED count_${name})
      set(count_${name} 0)
    endif()
    math(EXPR batch "${count_${name}} / 6")
    math(EXPR count_${name} "${count_${name}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${name}_${batch})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # Of private state with members of such names: there is one source that has it, though not as the main file.
  target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
endfunction()

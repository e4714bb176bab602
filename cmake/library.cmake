# SPDX-License-Identifier: BSD-3-Clause
# Installs the core for programs without ROS: find_package(posefusion) gives posefusion::core.
include(CMakePackageConfigHelpers)

# What a program outside needs, and what these include; the other headers may change at any time.
set(POSEFUSION_HEADERS
  blur/config.hpp calibration/color_camera.hpp calibration/config.hpp config/fields.hpp core/camera.hpp core/depth_sensor.hpp core/error.hpp
  core/frame.hpp core/map_pose.hpp core/trajectory.hpp frame/config.hpp frame/sensor_config.hpp
  graph/config.hpp io/frame_source.hpp io/trajectory_file.hpp loop/config.hpp map/config.hpp map/surfels.hpp
  pose/config.hpp pose/detector.hpp pose/skeleton.hpp robot/config.hpp run/slam.hpp segmentation/config.hpp slam/config.hpp
  slam/outcome.hpp tracking/config.hpp)
foreach(header ${POSEFUSION_HEADERS})
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES include/posefusion/${header}
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/posefusion/${folder})
endforeach()

set(POSEFUSION_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/posefusion)
set_target_properties(posefusion_core PROPERTIES EXPORT_NAME core
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
install(TARGETS posefusion_core EXPORT posefusion
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT posefusion NAMESPACE posefusion:: FILE posefusionTargets.cmake
  DESTINATION ${POSEFUSION_PACKAGE_DIR})
configure_package_config_file(cmake/posefusionConfig.cmake.in ${CMAKE_BINARY_DIR}/posefusionConfig.cmake
  INSTALL_DESTINATION ${POSEFUSION_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/posefusionConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/posefusionConfig.cmake
  ${CMAKE_BINARY_DIR}/posefusionConfigVersion.cmake DESTINATION ${POSEFUSION_PACKAGE_DIR})

# Read when it runs: the weights of the person model, settings of known pose networks.
install(FILES models/person.onnx DESTINATION ${CMAKE_INSTALL_DATADIR}/posefusion/models)
install(DIRECTORY config/models DESTINATION ${CMAKE_INSTALL_DATADIR}/posefusion/config)

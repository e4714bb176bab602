// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/loader.h>
#include <ros/ros.h>

/// A nodelet manager in a program of our own: `nodelet load` takes it like the stock manager.
/// Unlike that one it is built with our flags, so that sanitizers see the nodelets.
int main(int argc, char** argv) {
  ros::init(argc, argv, "posefusion_nodelet_host");
  nodelet::Loader loader(true);
  ros::spin();
  return 0;
}

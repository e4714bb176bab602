// SPDX-License-Identifier: BSD-3-Clause
#include "driver_settings.hpp"

#include <ros/console.h>

#include <set>
#include <vector>

#include "posefusion/core/error.hpp"

namespace pf::openni2 {
namespace {

/// Reads parameters and remembers which ones there are.
class Reader {
 public:
  explicit Reader(const ros::NodeHandle& nh) : nh_(nh) {}

  template <typename Value>
  void read(const char* name, Value& value, const char* expected) {
    known_.insert(name);
    if (!nh_.hasParam(name) || nh_.getParam(name, value)) return;
    XmlRpc::XmlRpcValue found;
    nh_.getParam(name, found);
    throw InputError(nh_.resolveName(name) + " is " + found.toXml() + ", expected " + expected);
  }
  void readMode(const char* name, StreamMode& mode) {
    std::string text = toText(mode);
    read(name, text, "a text like 640x480@30");
    try {
      mode = parseMode(text);
    } catch (const InputError& error) {
      throw InputError(nh_.resolveName(name) + ": " + error.what());
    }
  }
  void readPositive(const char* name, double& value) {
    read(name, value, "a number");
    if (value > 0.0) return;
    throw InputError(nh_.resolveName(name) + " is " + std::to_string(value) +
                     ", expected a number above 0");
  }
  /// `others`: parameters that are read elsewhere.
  void warnOfUnknown(std::set<std::string> others) const {
    others.insert(known_.begin(), known_.end());
    const std::string prefix = nh_.getNamespace() + "/";
    std::vector<std::string> names;
    nh_.getParamNames(names);
    for (const auto& name : names) {
      if (name.rfind(prefix, 0) != 0 || others.count(name.substr(prefix.size())) > 0) continue;
      ROS_WARN("%s: the OpenNI2 driver has no such parameter", name.c_str());
    }
  }

 private:
  const ros::NodeHandle& nh_;
  std::set<std::string> known_;
};

}  // namespace

DriverSettings readDriverSettings(const ros::NodeHandle& private_nh) {
  DriverSettings settings;
  Reader reader(private_nh);
  reader.read("device_id", settings.device.device, "a text: #1, a URI, a serial number, an .oni");
  reader.readMode("color_mode", settings.device.color_mode);
  reader.readMode("depth_mode", settings.device.depth_mode);
  reader.read("depth_registration", settings.device.depth_registration, "true or false");
  reader.read("color_depth_synchronization", settings.device.frame_sync, "true or false");
  reader.read("file_repeat", settings.device.file_repeat, "true or false");
  reader.readPositive("file_speed", settings.device.file_speed);
  reader.read("rgb_frame_id", settings.rgb_frame_id, "a text");
  reader.read("depth_frame_id", settings.depth_frame_id, "a text");
  reader.read("rgb_camera_info_url", settings.rgb_camera_info_url, "a text");
  reader.read("depth_camera_info_url", settings.depth_camera_info_url, "a text");
  reader.readPositive("reconnect_period_s", settings.reconnect_period_s);
  reader.readPositive("stall_timeout_s", settings.stall_timeout_s);
  reader.read("record_folder", settings.record_folder, "a text");
  reader.warnOfUnknown({"auto_exposure", "auto_white_balance", "exposure", "gain", "max_exposure",
                        "color_time_offset", "depth_time_offset", "diagnostic_period"});
  return settings;
}

}  // namespace pf::openni2

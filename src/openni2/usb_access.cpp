// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_openni2/usb_access.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace pf::openni2 {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrimeSenseVendor = "1d27";

std::string attribute(const fs::path& device, const char* name) {
  std::string value;
  std::ifstream(device / name) >> value;
  return value;
}

/// "001/004", as the nodes are named.
std::string nodeName(const fs::path& device) {
  const std::string bus = attribute(device, "busnum"), number = attribute(device, "devnum");
  if (bus.empty() || number.empty()) return "";
  char name[32];
  std::snprintf(name, sizeof name, "%03d/%03d", std::atoi(bus.c_str()), std::atoi(number.c_str()));
  return name;
}

std::string advice(const std::string& product, const std::string& node) {
  const std::string id = std::string(kPrimeSenseVendor) + ":" + product;
  return "no permission to open the camera " + id + " at " + node +
         ": its udev rule is missing. Debian and Ubuntu install "
         "/lib/udev/rules.d/60-libopenni2-0.rules with the package libopenni2-0. Without it, "
         "write into /etc/udev/rules.d/60-openni2.rules the line "
         "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"" +
         kPrimeSenseVendor + "\", ATTR{idProduct}==\"" + product +
         "\", MODE:=\"0666\" and run 'sudo udevadm control --reload-rules && sudo udevadm "
         "trigger', or plug the camera in again";
}

}  // namespace

std::string missingUsbPermission(const std::string& sysfs_devices,
                                 const std::string& device_nodes) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(sysfs_devices, error)) {
    if (attribute(entry.path(), "idVendor") != kPrimeSenseVendor) continue;
    const std::string name = nodeName(entry.path());
    if (name.empty()) continue;
    const std::string node = device_nodes + "/" + name;
    if (faccessat(AT_FDCWD, node.c_str(), R_OK | W_OK, AT_EACCESS) == 0) continue;
    if (errno == EACCES) return advice(attribute(entry.path(), "idProduct"), node);
  }
  return "";
}

}  // namespace pf::openni2

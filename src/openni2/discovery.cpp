// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_openni2/discovery.hpp"

#include <algorithm>
#include <filesystem>

#include "posefusion/core/error.hpp"
#include "posefusion_openni2/usb_access.hpp"
#include "status.hpp"

namespace pf::openni2 {
namespace {

std::string listed(const std::vector<DeviceDescription>& devices) {
  std::string text;
  for (const auto& device : devices) {
    text +=
        (text.empty() ? "" : ", ") + device.vendor + " " + device.name + " (" + device.uri + ")";
  }
  return text.empty() ? "no camera is connected" : "connected: " + text;
}

[[noreturn]] void failNotFound(const std::string& wanted, const std::string& found) {
  const std::string permission = missingUsbPermission();
  throw InputError("no OpenNI2 device: looked for " + wanted + "; " + found +
                   (permission.empty() ? "" : "; " + permission));
}

/// "#2" -> 2, empty -> 1, anything else -> 0.
std::size_t ordinalOf(const std::string& device) {
  if (device.empty()) return 1;
  const bool digits = device[0] == '#' && device.size() > 1 && device.size() < 4 &&
                      std::all_of(device.begin() + 1, device.end(), ::isdigit);
  return digits ? static_cast<std::size_t>(std::stoi(device.substr(1))) : 0;
}

/// The serial number, or what is in its way in brackets.
std::string serialOf(const std::string& uri) {
  openni::Device device;
  if (device.open(uri.c_str()) != openni::STATUS_OK)
    return "(cannot be opened: " + lastError() + ")";
  char serial[ONI_MAX_STR] = {};
  int size = sizeof serial;
  const auto status = device.getProperty(ONI_DEVICE_PROPERTY_SERIAL_NUMBER, serial, &size);
  device.close();
  return status == openni::STATUS_OK ? serial : "(no serial number)";
}

std::string findSerial(const std::string& serial, const std::vector<DeviceDescription>& devices) {
  std::string found;
  for (const auto& device : devices) {
    const std::string its = serialOf(device.uri);
    if (its == serial) return device.uri;
    found += (found.empty() ? "" : ", ") + device.uri + " has " + its;
  }
  failNotFound("URI or serial number '" + serial + "'",
               found.empty() ? listed(devices) : "serial numbers: " + found);
}

}  // namespace

bool isFileName(const std::string& device) {
  return device.size() > 4 && device.compare(device.size() - 4, 4, ".oni") == 0;
}

std::vector<DeviceDescription> listDevices() {
  openni::Array<openni::DeviceInfo> infos;
  openni::OpenNI::enumerateDevices(&infos);
  std::vector<DeviceDescription> devices;
  for (int i = 0; i < infos.getSize(); ++i) {
    if (isFileName(infos[i].getUri())) continue;  // a recording being played
    devices.push_back({infos[i].getUri(), infos[i].getVendor(), infos[i].getName()});
  }
  return devices;
}

std::string findUri(const std::string& device) {
  if (isFileName(device)) {
    if (std::filesystem::is_regular_file(device)) return device;
    throw InputError("device '" + device + "': no such file");
  }
  const auto devices = listDevices();
  if (const std::size_t ordinal = ordinalOf(device); ordinal > 0) {
    if (ordinal <= devices.size()) return devices[ordinal - 1].uri;
    failNotFound(device.empty() ? "any camera" : "camera " + device, listed(devices));
  }
  for (const auto& candidate : devices) {
    if (candidate.uri == device) return device;
  }
  return findSerial(device, devices);
}

}  // namespace pf::openni2

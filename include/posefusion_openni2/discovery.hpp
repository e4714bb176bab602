// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pf::openni2 {

/// A camera that OpenNI2 sees.
struct DeviceDescription {
  std::string uri;
  std::string vendor;
  std::string name;
};

/// The cameras connected now (no files). Needs a Session.
std::vector<DeviceDescription> listDevices();

/// Whether the setting names an .oni file.
bool isFileName(const std::string& device);

/// The URI of `device` (see DeviceSettings). Throws InputError that names what was looked for, what
/// there is, and a missing udev rule where that is the cause. Opens cameras to compare serial
/// numbers. Needs a Session.
std::string findUri(const std::string& device);

}  // namespace pf::openni2

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf::openni2 {

/// Looks for depth cameras on the USB (vendor 1d27, PrimeSense and ASUS) that this process may not
/// write to, as OpenNI2 has to. Says which, and which udev rule is missing; empty when there is
/// none. The folders are those of Linux's sysfs and of the device nodes.
std::string missingUsbPermission(const std::string& sysfs_devices = "/sys/bus/usb/devices",
                                 const std::string& device_nodes = "/dev/bus/usb");

}  // namespace pf::openni2

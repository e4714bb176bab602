// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf::openni2 {

/// Size and rate of a stream.
struct StreamMode {
  int width = 640;   ///< pixels
  int height = 480;  ///< pixels
  int fps = 30;      ///< frames a second

  bool operator==(const StreamMode& other) const {
    return width == other.width && height == other.height && fps == other.fps;
  }
};

/// "640x480@30".
std::string toText(const StreamMode& mode);
/// Reads "640x480@30"; throws InputError for anything else.
StreamMode parseMode(const std::string& text);

/// What is opened and how. Fixed while a device is open.
struct DeviceSettings {
  /// Empty or "#1": the first camera found, "#2": the second; a URI; a serial number; or the path
  /// of an .oni file.
  std::string device;
  StreamMode color_mode;           ///< of a camera; a file plays what it holds
  StreamMode depth_mode;           ///< of a camera; a file plays what it holds
  bool depth_registration = true;  ///< depth in the pixels of the colour image
  bool frame_sync = true;          ///< colour and depth taken at the same time
  bool file_repeat = false;        ///< plays an .oni file again and again
  double file_speed = 1.0;         ///< 1: as recorded; 2: twice as fast
};

/// How bright the colour image becomes. May change while the device streams.
struct ExposureSettings {
  bool auto_exposure = true;
  bool auto_white_balance = true;
  int exposure = 0;      ///< used without auto exposure, in the device's steps; 0 leaves it alone
  int gain = 0;          ///< used without auto exposure, in the device's steps; 0 leaves it alone
  int max_exposure = 0;  ///< no exposure above this, in the device's steps; 0 is no limit
};

}  // namespace pf::openni2

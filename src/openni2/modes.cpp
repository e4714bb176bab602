// SPDX-License-Identifier: BSD-3-Clause
#include "modes.hpp"

#include "posefusion/core/error.hpp"

namespace pf::openni2 {
namespace {

std::string nameOf(openni::PixelFormat format) {
  switch (format) {
    case openni::PIXEL_FORMAT_DEPTH_1_MM:
      return "1 mm";
    case openni::PIXEL_FORMAT_DEPTH_100_UM:
      return "0.1 mm";
    case openni::PIXEL_FORMAT_RGB888:
      return "RGB";
    case openni::PIXEL_FORMAT_YUV422:
      return "YUV422";
    case openni::PIXEL_FORMAT_YUYV:
      return "YUYV";
    case openni::PIXEL_FORMAT_GRAY8:
      return "8-bit grey";
    case openni::PIXEL_FORMAT_GRAY16:
      return "16-bit grey";
    case openni::PIXEL_FORMAT_JPEG:
      return "JPEG";
    default:
      return "format " + std::to_string(format);
  }
}

StreamMode sizeAndRate(const openni::VideoMode& mode) {
  return {mode.getResolutionX(), mode.getResolutionY(), mode.getFps()};
}

}  // namespace

openni::PixelFormat formatOf(StreamKind kind) {
  return kind == StreamKind::color ? openni::PIXEL_FORMAT_RGB888 : openni::PIXEL_FORMAT_DEPTH_1_MM;
}

std::string offersOf(const openni::SensorInfo& sensor) {
  const auto& modes = sensor.getSupportedVideoModes();
  std::string text;
  for (int i = 0; i < modes.getSize(); ++i) {
    text += (i == 0 ? "" : ", ") + toText(sizeAndRate(modes[i])) + " " +
            nameOf(modes[i].getPixelFormat());
  }
  return text.empty() ? "nothing" : text;
}

openni::VideoMode chooseMode(const openni::SensorInfo& sensor, StreamKind kind,
                             const StreamMode& wanted) {
  const auto& modes = sensor.getSupportedVideoModes();
  for (int i = 0; i < modes.getSize(); ++i) {
    if (sizeAndRate(modes[i]) == wanted && modes[i].getPixelFormat() == formatOf(kind)) {
      return modes[i];
    }
  }
  throw InputError(std::string("the device has no ") + openni2::nameOf(kind) + " mode " +
                   toText(wanted) + " " + nameOf(formatOf(kind)) + "; it offers " +
                   offersOf(sensor));
}

}  // namespace pf::openni2

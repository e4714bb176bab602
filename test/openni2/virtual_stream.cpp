// SPDX-License-Identifier: BSD-3-Clause
#include "virtual_stream.hpp"

#include <cmath>
#include <cstring>

namespace pf::openni2 {
namespace {

template <typename Value>
OniStatus answer(const Value& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  *size = sizeof value;
  return ONI_STATUS_OK;
}

bool isEachNth(int index, int n) { return n > 0 && index % n == 0; }

bool isCameraSetting(int id) {
  return id >= ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE && id <= ONI_STREAM_PROPERTY_GAIN;
}

}  // namespace

const std::vector<OniVideoMode>& virtualModes(OniSensorType sensor) {
  static const std::vector<OniVideoMode> color = {{ONI_PIXEL_FORMAT_YUV422, 640, 480, 30},
                                                  {ONI_PIXEL_FORMAT_RGB888, 320, 240, 30},
                                                  {ONI_PIXEL_FORMAT_RGB888, 320, 240, 60},
                                                  {ONI_PIXEL_FORMAT_RGB888, 640, 480, 30},
                                                  {ONI_PIXEL_FORMAT_RGB888, 1280, 1024, 30}};
  static const std::vector<OniVideoMode> depth = {{ONI_PIXEL_FORMAT_DEPTH_1_MM, 320, 240, 30},
                                                  {ONI_PIXEL_FORMAT_DEPTH_1_MM, 320, 240, 60},
                                                  {ONI_PIXEL_FORMAT_DEPTH_1_MM, 640, 480, 30},
                                                  {ONI_PIXEL_FORMAT_DEPTH_100_UM, 640, 480, 30}};
  return sensor == ONI_SENSOR_COLOR ? color : depth;
}

VirtualStream::VirtualStream(VirtualDevice& device, OniSensorType sensor, Clock::time_point started)
    : device_(device), sensor_(sensor), started_(started), mode_(virtualModes(sensor)[1]) {
  ++device_.open_streams;
}

VirtualStream::~VirtualStream() {
  stop();
  --device_.open_streams;
}

OniStatus VirtualStream::start() {
  if (running_.exchange(true)) return ONI_STATUS_OK;
  ++device_.running_streams;
  thread_ = std::thread([this] { run(); });
  return ONI_STATUS_OK;
}

void VirtualStream::stop() {
  if (!running_.exchange(false)) return;
  thread_.join();
  --device_.running_streams;
}

OniStatus VirtualStream::setMode(const OniVideoMode& mode) {
  if (device_.refuses_modes) return ONI_STATUS_NOT_SUPPORTED;
  for (const auto& offered : virtualModes(sensor_)) {
    if (std::memcmp(&offered, &mode, sizeof mode) != 0) continue;
    mode_ = mode;
    notifyAllProperties();
    return ONI_STATUS_OK;
  }
  return ONI_STATUS_BAD_PARAMETER;
}

OniStatus VirtualStream::setCamera(int id, int value) {
  if (!device_.has_camera_settings) return ONI_STATUS_NOT_SUPPORTED;
  switch (id) {
    case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
      device_.auto_white_balance = value;
      break;
    case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
      device_.auto_exposure = value;
      break;
    case ONI_STREAM_PROPERTY_EXPOSURE:
      device_.exposure = value;
      break;
    default:
      device_.gain = value;
  }
  return ONI_STATUS_OK;
}

OniStatus VirtualStream::getCamera(int id, void* data, int* size) const {
  if (!device_.has_camera_settings) return ONI_STATUS_NOT_SUPPORTED;
  if (id != ONI_STREAM_PROPERTY_EXPOSURE) return ONI_STATUS_NOT_IMPLEMENTED;
  const bool automatic = device_.auto_exposure != 0;
  return answer<int>(automatic ? device_.automatic_exposure : device_.exposure, data, size);
}

OniStatus VirtualStream::setProperty(int id, const void* data, int size) {
  if (id == ONI_STREAM_PROPERTY_VIDEO_MODE && size == sizeof(OniVideoMode)) {
    return setMode(*static_cast<const OniVideoMode*>(data));
  }
  if (size != sizeof(int)) return ONI_STATUS_BAD_PARAMETER;
  const int value = *static_cast<const int*>(data);
  if (id == ONI_STREAM_PROPERTY_MIRRORING) {
    if (device_.keeps_mirroring) return ONI_STATUS_NOT_SUPPORTED;
    device_.mirroring[isColor() ? 0 : 1] = value;
    return ONI_STATUS_OK;
  }
  return isColor() && isCameraSetting(id) ? setCamera(id, value) : ONI_STATUS_NOT_IMPLEMENTED;
}

float VirtualStream::fov(bool horizontal) const {
  // 525 pixels of focal length at 640 x 480, where square pixels are cut to the mode's shape.
  const float pixels = horizontal ? 320.0f : 320.0f * mode_.resolutionY / mode_.resolutionX;
  return 2.0f * std::atan(pixels / 525.0f);
}

OniStatus VirtualStream::getProperty(int id, void* data, int* size) {
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return answer(mode_, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return answer(fov(true), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return answer(fov(false), data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return answer(stride(), data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return answer(isColor() ? 255 : 10000, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return answer<int>(device_.keeps_mirroring || device_.mirroring[isColor() ? 0 : 1] != 0, data,
                         size);
    case ONI_STREAM_PROPERTY_CROPPING:
      return answer(OniCropping{FALSE, 0, 0, mode_.resolutionX, mode_.resolutionY}, data, size);
    default:
      return isColor() && isCameraSetting(id) ? getCamera(id, data, size)
                                              : ONI_STATUS_NOT_IMPLEMENTED;
  }
}

OniBool VirtualStream::isPropertySupported(int id) {
  if (isCameraSetting(id)) return isColor() && device_.has_camera_settings;
  return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_MIRRORING ||
         id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV || id == ONI_STREAM_PROPERTY_VERTICAL_FOV ||
         id == ONI_STREAM_PROPERTY_STRIDE || id == ONI_STREAM_PROPERTY_MAX_VALUE ||
         id == ONI_STREAM_PROPERTY_CROPPING;
}

void VirtualStream::notifyAllProperties() {
  std::this_thread::sleep_for(std::chrono::milliseconds(device_.notify_ms));
  // A recording needs all of these; one made without the cropping plays no frames.
  for (const int id :
       {ONI_STREAM_PROPERTY_VIDEO_MODE, ONI_STREAM_PROPERTY_HORIZONTAL_FOV,
        ONI_STREAM_PROPERTY_VERTICAL_FOV, ONI_STREAM_PROPERTY_STRIDE, ONI_STREAM_PROPERTY_MAX_VALUE,
        ONI_STREAM_PROPERTY_MIRRORING, ONI_STREAM_PROPERTY_CROPPING}) {
    char data[64];
    int size = sizeof data;
    if (getProperty(id, data, &size) == ONI_STATUS_OK) raisePropertyChanged(id, data, size);
  }
}

void VirtualStream::run() {
  const std::chrono::nanoseconds period(1'000'000'000 / mode_.fps);
  int index = static_cast<int>((Clock::now() - started_) / period) + 1;
  for (; running_; ++index) {
    std::this_thread::sleep_until(started_ + index * period);
    // Counted before the flags are read: after a test has stalled the camera and sees no frame
    // under way, none will come.
    ++device_.under_way;
    sendUnlessSilent(index);
    --device_.under_way;
  }
}

void VirtualStream::sendUnlessSilent(int index) {
  if (!device_.plugged || device_.stalled || isEachNth(index, device_.drop_every)) return;
  if (isEachNth(index, device_.late_every)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(device_.late_by_ms));
  }
  send(index);
}

void VirtualStream::send(int index) {
  raise(index, isEachNth(index, device_.short_every));
  if (isEachNth(index, device_.duplicate_every)) {
    // Apart, or the library hands out only one of the two.
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    raise(index, false);
  }
}

void VirtualStream::raise(int index, bool cut) {
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return;
  if (isColor()) {
    virtualColor(index, mode_.resolutionX, mode_.resolutionY, static_cast<uint8_t*>(frame->data));
  } else {
    virtualDepth(index, mode_.resolutionX, mode_.resolutionY, static_cast<uint16_t*>(frame->data));
  }
  frame->dataSize = stride() * mode_.resolutionY / (cut ? 2 : 1);
  frame->sensorType = sensor_;
  frame->timestamp = static_cast<uint64_t>(virtualTimeUs(index, mode_.fps));
  frame->frameIndex = index;
  frame->width = mode_.resolutionX;
  frame->height = mode_.resolutionY;
  frame->videoMode = mode_;
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = frame->cropOriginY = 0;
  frame->stride = stride();
  ++device_.sent;
  device_.raised_ns[isColor() ? 0 : 1] =
      Clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

}  // namespace pf::openni2

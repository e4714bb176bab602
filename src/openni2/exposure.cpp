// SPDX-License-Identifier: BSD-3-Clause
#include "exposure.hpp"

#include <algorithm>

namespace pf::openni2 {

bool ExposureControl::set(int property, int value) const {
  return color_.setProperty(property, &value, sizeof value) == openni::STATUS_OK;
}

std::optional<int> ExposureControl::exposure() const {
  int value = 0, size = sizeof value;
  const auto status = color_.getProperty(ONI_STREAM_PROPERTY_EXPOSURE, &value, &size);
  if (status != openni::STATUS_OK) return std::nullopt;
  return value;
}

void ExposureControl::setFixed(const ExposureSettings& settings,
                               std::vector<std::string>& failures) {
  int exposure = settings.exposure;
  if (settings.max_exposure > 0) exposure = std::min(exposure, settings.max_exposure);
  if (exposure > 0 && !set(ONI_STREAM_PROPERTY_EXPOSURE, exposure)) {
    failures.push_back("the device does not take exposure " + std::to_string(exposure));
  }
  if (settings.gain > 0 && !set(ONI_STREAM_PROPERTY_GAIN, settings.gain)) {
    failures.push_back("the device does not take gain " + std::to_string(settings.gain));
  }
}

std::vector<std::string> ExposureControl::apply(const ExposureSettings& settings) {
  settings_ = settings;
  if (!color_.isPropertySupported(ONI_STREAM_PROPERTY_AUTO_EXPOSURE)) {
    return {"the device has no settings of exposure and white balance: they are left as they are"};
  }
  std::vector<std::string> failures;
  if (!set(ONI_STREAM_PROPERTY_AUTO_EXPOSURE, settings.auto_exposure)) {
    failures.push_back("the device does not switch its auto exposure");
  }
  if (!set(ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE, settings.auto_white_balance)) {
    failures.push_back("the device does not switch its auto white balance");
  }
  if (!settings.auto_exposure) setFixed(settings, failures);
  if (settings.auto_exposure && settings.max_exposure > 0 && !exposure()) {
    failures.push_back(
        "max_exposure has no effect: the device does not report its exposure; set auto_exposure to "
        "false and exposure to what the motion allows");
  }
  return failures;
}

bool ExposureControl::limit() {
  if (!settings_.auto_exposure || settings_.max_exposure <= 0) return false;
  const auto now = exposure();
  if (!now || *now <= settings_.max_exposure) return false;
  settings_.auto_exposure = false;
  return set(ONI_STREAM_PROPERTY_AUTO_EXPOSURE, 0) &&
         set(ONI_STREAM_PROPERTY_EXPOSURE, settings_.max_exposure);
}

}  // namespace pf::openni2

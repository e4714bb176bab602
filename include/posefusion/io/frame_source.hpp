// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/calibration/color_camera.hpp"
#include "posefusion/core/frame.hpp"
#include "posefusion/core/trajectory.hpp"
#include "posefusion/pose/detector.hpp"

namespace pf {

/// One frame of a recording; where it cannot be read, `defect` says why and the images are empty.
struct SourceFrame {
  RgbdFrame frame;
  std::string defect;
};

/// What of a recording gives no frame. Complete once next() has returned nothing.
struct InputReport {
  std::size_t color_without_depth = 0;  ///< colour images that no depth image is near enough to
  std::size_t depth_without_color = 0;
  std::vector<std::string> notes;  ///< what the user should know, one sentence each
};

/// A recorded sequence: a TUM folder or a bag. One reader at a time.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Number of frames that next() will give, for progress.
  virtual std::size_t frameCount() const = 0;

  /// The next frame in order of time; nothing at the end.
  virtual std::optional<SourceFrame> next() = 0;

  /// People recorded with it; empty when there are none.
  virtual RecordedPeople people() { return {}; }

  /// True poses recorded with it; empty when there are none.
  virtual Trajectory truth() { return {}; }

  /// The kind of depth camera that it says it was taken by, one of sensorKinds(); empty: it does
  /// not say.
  virtual std::string sensorKind() const { return {}; }

  /// The camera of its colour images, where they are not registered to depth.
  virtual std::optional<ColorCamera> colorCamera() { return std::nullopt; }

  virtual InputReport report() const { return {}; }
};

/// Opens a TUM folder: associations.txt, or rgb.txt and depth.txt matched by nearest stamp (less
/// than 20 ms apart); the camera from `camera_file` when that is not empty, else from camera.yaml,
/// else by the folder's name (knownCamera()).
/// Frames come in the order of the lists; one whose stamp is not later than all before it comes
/// with a defect. People from people.json, truth from groundtruth.txt. Throws InputError naming
/// what is missing.
std::unique_ptr<FrameSource> openTumFolder(const std::string& folder,
                                           const std::string& camera_file = "");

/// The stamps (ns) of the frames that openTumFolder() would give, without reading an image, in the
/// order of the lists. Throws InputError naming what is missing.
std::vector<std::int64_t> listTumFrames(const std::string& folder);

}  // namespace pf

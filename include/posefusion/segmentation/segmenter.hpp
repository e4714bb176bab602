// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/frame.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/frame/model_view.hpp"
#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/config.hpp"
#include "posefusion/segmentation/moving_object.hpp"

namespace pf {

/// People farther away (m) are not searched for: depth cameras cannot separate them from a wall.
constexpr double kFarthestPerson_m = 8.0;

/// A frame without its people and other moving objects.
struct Segmentation {
  cv::Mat mask;          ///< CV_8UC1, frame size, 255 = a person or a moving object; empty when
                         ///< there is none
  cv::Mat static_depth;  ///< depth of the frame, the mask removed (0 or NaN); the very same pixels
                         ///< as the input when there is none
  People people;         ///< as used: detected, or carried forward to this frame
  std::vector<MovingObject> moving;  ///< people and other moving objects that are seen, in the
                                     ///< frame that ModelView::T_world_map leads to; none while the
                                     ///< camera's place in it is not known
};

/// Finds the pixels of people: seeds from joints, min-cut over the organised points, carried
/// forward between detections; and, where there is a map, of other moving objects. Keeps the last
/// mask and joints. Not thread safe.
class PeopleSegmenter {
 public:
  /// Of depth as `sensor` measures it.
  explicit PeopleSegmenter(const SegmentationConfig& config, const DepthSensor& sensor = {});
  ~PeopleSegmenter();

  /// `flow` leads from the last frame to this one (also without people): it carries people, and
  /// shows where the camera is to be expected. After a change of the image size no person is
  /// carried. `background` is the map rendered at the last trusted pose, with the stamp of its
  /// frame: what agrees with it is no person. Null while there is no map or the camera is lost in
  /// it: nothing is known of the background then, and people are carried a third as long.
  /// `up_camera` is the upward direction in the camera frame when known (TF or configuration).
  Segmentation segment(const RgbdFrame& frame, const FlowImages& flow, const People& people,
                       const ModelView* background,
                       const std::optional<Eigen::Vector3d>& up_camera = std::nullopt);
  void reset();

  /// From the next frame on; people carried forward stay.
  void set(const SegmentationConfig& config) { config_ = config; }

 private:
  struct State;
  bool findPeople(const RgbdFrame& frame, const FlowImages& flow, const People& people);
  void keepPeople(bool with_map, Segmentation& result);
  void expectObjects(const RgbdFrame& frame, const ModelView* view,
                     const Eigen::Isometry3d& T_uncorrected_camera);
  void findObjects(const RgbdFrame& frame, const ModelView* view,
                   const Eigen::Isometry3d& T_uncorrected_camera, std::vector<std::uint8_t>& taken,
                   Segmentation& result);
  void placePeople(const ModelView* view, const Eigen::Isometry3d& T_uncorrected_camera,
                   Segmentation& result);
  Segmentation segmentAsThePaper(const RgbdFrame& frame, const People& people,
                                 const std::optional<Eigen::Vector3d>& up_camera);

  SegmentationConfig config_;
  DepthSensor sensor_;
  std::unique_ptr<State> state_;
};

}  // namespace pf

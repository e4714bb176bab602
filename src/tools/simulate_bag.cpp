// SPDX-License-Identifier: BSD-3-Clause
#include "simulate_bag.hpp"

#include <geometry_msgs/PoseStamped.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include "new_bag.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/names.hpp"
#include "simulate_bag_senses.hpp"
#include "simulator/truth.hpp"

namespace pf {
namespace {

using simulator::SimulatedFrame;
using simulator::Simulation;

// The names that openni2_launch gives them.
constexpr char kColor[] = "/camera/rgb/image_raw";
constexpr char kColorInfo[] = "/camera/rgb/camera_info";
constexpr char kDepth[] = "/camera/depth_registered/image_raw";
constexpr char kDepthInfo[] = "/camera/depth_registered/camera_info";
constexpr char kMask[] = "/truth/mask";
constexpr char kThingMask[] = "/truth/thing_mask";
constexpr char kEvents[] = "/truth/events";
constexpr char kWorld[] = "world";

class BagOutput : public simulator::Output {
 public:
  explicit BagOutput(const std::string& path) : bag_(path) {}

  void add(const SimulatedFrame& frame) override {
    ++frames_;
    if (frame.dropped) return;
    using namespace posefusion_ros;
    const auto color = headerAt(frame.frame.stamp_ns, frames::kOptical);
    const auto depth = headerAt(frame.depth_stamp_ns, frames::kOptical);
    bag_.write(kColorInfo, toCameraInfo(frame.frame.camera, color), color);
    bag_.write(kColor, *toImage(frame.frame.color, "rgb8", color), color);
    bag_.write(kDepthInfo, toCameraInfo(frame.frame.camera, depth), depth);
    bag_.write(kDepth, *toDepthImage(frame.frame, depth), depth);
    bag_.write(kMask, *toImage(frame.mask, "mono8", color), color);
    if (!frame.thing_mask.empty()) {
      bag_.write(kThingMask, *toImage(frame.thing_mask, "mono8", color), color);
    }
    bag_.write(bag_topics::kPeople, toMessage(simulator::asDetected(frame), color), color);
  }

  void finish(const Simulation& simulation) override {
    for (const StampedPose& stamped : simulation.truth(frames_)) writePose(stamped);
    for (const auto& event : simulation.events(frames_)) {
      std_msgs::String text;
      text.data = event.kind + " until " + formatStamp(simulation.stampOf(event.end_s));
      bag_.write(kEvents, text, headerAt(simulation.stampOf(event.start_s), kWorld));
    }
    writeSenses(simulation, frames_, bag_);
    bag_.commit();
  }

 private:
  void writePose(const StampedPose& stamped) {
    geometry_msgs::PoseStamped pose;
    pose.header = headerAt(stamped.stamp_ns, kWorld);
    pose.pose = posefusion_ros::toPose(stamped.T_world_camera);
    bag_.write(posefusion_ros::bag_topics::kTruth, pose, pose.header);
    tf2_msgs::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header = pose.header;
    // Not the frame of the images: the chain publishes that one itself.
    tf.transforms[0].child_frame_id = "camera_truth";
    tf.transforms[0].transform.translation.x = pose.pose.position.x;
    tf.transforms[0].transform.translation.y = pose.pose.position.y;
    tf.transforms[0].transform.translation.z = pose.pose.position.z;
    tf.transforms[0].transform.rotation = pose.pose.orientation;
    bag_.write("/tf", tf, pose.header);
  }

  NewBag bag_;
  int frames_ = 0;  // dropped ones too
};

}  // namespace

std::unique_ptr<simulator::Output> openBagOutput(const std::string& path) {
  return std::make_unique<BagOutput>(path);
}

}  // namespace pf

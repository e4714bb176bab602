// SPDX-License-Identifier: BSD-3-Clause
#include "simulate_bag.hpp"

#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion_ros/conversions.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/stage_messages.hpp"
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
constexpr char kEvents[] = "/truth/events";
constexpr char kWorld[] = "world";

std_msgs::Header headerAt(std::int64_t stamp_ns, const char* frame) {
  std_msgs::Header header;
  header.stamp = posefusion_ros::toTime(stamp_ns);
  header.frame_id = frame;
  return header;
}

class BagOutput : public simulator::Output {
 public:
  explicit BagOutput(const std::string& path)
      : path_(path), part_(path + ".part" + std::to_string(getpid())) {
    if (std::filesystem::exists(path_)) throw InputError(path + ": is there, expected a new bag");
    attempt([&] {
      bag_->open(part_, rosbag::bagmode::Write);
      bag_->setCompression(rosbag::compression::LZ4);
    });
  }
  ~BagOutput() override {
    if (part_.empty()) return;
    std::remove(part_.c_str());
    try {
      bag_->close();
    } catch (const rosbag::BagException&) {
      // On a full disk the bag's destructor would throw once more, and end the program.
      [[maybe_unused]] static rosbag::Bag* unfinished = nullptr;
      unfinished = bag_.release();
    }
  }

  void add(const SimulatedFrame& frame) override {
    ++frames_;
    if (frame.dropped) return;
    using namespace posefusion_ros;
    const auto color = headerAt(frame.frame.stamp_ns, frames::kOptical);
    const auto depth = headerAt(frame.depth_stamp_ns, frames::kOptical);
    write(kColorInfo, toCameraInfo(frame.frame.camera, color), color);
    write(kColor, *toImage(frame.frame.color, "rgb8", color), color);
    write(kDepthInfo, toCameraInfo(frame.frame.camera, depth), depth);
    write(kDepth, *toDepthImage(frame.frame, depth), depth);
    write(kMask, *toImage(frame.mask, "mono8", color), color);
    write(bag_topics::kPeople, toMessage(simulator::asDetected(frame), color), color);
  }

  void finish(const Simulation& simulation) override {
    for (const StampedPose& stamped : simulation.truth(frames_)) writePose(stamped);
    for (const auto& event : simulation.events(frames_)) {
      std_msgs::String text;
      text.data = event.kind + " until " + formatStamp(simulation.stampOf(event.end_s));
      write(kEvents, text, headerAt(simulation.stampOf(event.start_s), kWorld));
    }
    attempt([&] { bag_->close(); });
    std::error_code error;
    std::filesystem::rename(part_, path_, error);
    if (error) throw InputError(path_ + ": cannot be given its name: " + error.message());
    part_.clear();
  }

 private:
  template <typename Message>
  void write(const char* topic, const Message& message, const std_msgs::Header& header) {
    attempt([&] { bag_->write(topic, header.stamp, message); });
  }

  template <typename Call>
  void attempt(const Call& call) const {
    try {
      errno = 0;
      call();
    } catch (const rosbag::BagException& error) {
      const std::string reason = errno != 0 ? std::strerror(errno) : error.what();
      throw InputError(path_ + ": cannot be written: " + reason);
    }
  }

  void writePose(const StampedPose& stamped) {
    geometry_msgs::PoseStamped pose;
    pose.header = headerAt(stamped.stamp_ns, kWorld);
    pose.pose = posefusion_ros::toPose(stamped.T_world_camera);
    write(posefusion_ros::bag_topics::kTruth, pose, pose.header);
    tf2_msgs::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header = pose.header;
    // Not the frame of the images: the chain publishes that one itself.
    tf.transforms[0].child_frame_id = "camera_truth";
    tf.transforms[0].transform.translation.x = pose.pose.position.x;
    tf.transforms[0].transform.translation.y = pose.pose.position.y;
    tf.transforms[0].transform.translation.z = pose.pose.position.z;
    tf.transforms[0].transform.rotation = pose.pose.orientation;
    write("/tf", tf, pose.header);
  }

  std::string path_;
  std::string part_;
  int frames_ = 0;  // dropped ones too
  std::unique_ptr<rosbag::Bag> bag_ = std::make_unique<rosbag::Bag>();
};

}  // namespace

std::unique_ptr<simulator::Output> openBagOutput(const std::string& path) {
  return std::make_unique<BagOutput>(path);
}

}  // namespace pf

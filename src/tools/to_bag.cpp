// SPDX-License-Identifier: BSD-3-Clause
// posefusion_to_bag: writes a TUM folder as a ROS bag.
#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "posefusion/core/error.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/names.hpp"
#include "tool.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;

/// A bag that gets its name only when it is whole.
class BagFile {
 public:
  explicit BagFile(const std::string& path)
      : path_(path), temporary_(path + ".part" + std::to_string(getpid())) {
    try {
      bag_.open(temporary_, rosbag::bagmode::Write);
    } catch (const rosbag::BagException& error) {
      throw InputError(path_ + ": cannot be written: " + error.what());
    }
  }
  ~BagFile() {
    if (!temporary_.empty()) std::remove(temporary_.c_str());
  }
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  template <typename Message>
  void write(const char* topic, const Message& message, const ros::Time& time) {
    bag_.write(topic, time, message);
  }

  void commit() {
    bag_.close();
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
      throw InputError(path_ + ": cannot be replaced");
    }
    temporary_.clear();
  }

 private:
  std::string path_;
  std::string temporary_;
  rosbag::Bag bag_;
};

std_msgs::Header headerAt(std::int64_t stamp_ns, const char* frame) {
  std_msgs::Header header;
  header.stamp = toTime(stamp_ns);
  header.frame_id = frame;
  return header;
}

void writeTruth(const pf::Trajectory& truth, BagFile& bag) {
  for (const auto& stamped : truth) {
    geometry_msgs::PoseStamped pose;
    pose.header = headerAt(stamped.stamp_ns, "world");
    pose.pose = toPose(stamped.T_world_camera);
    bag.write(bag_topics::kTruth, pose, pose.header.stamp);
  }
}

void writeFrame(const pf::RgbdFrame& frame, BagFile& bag) {
  const std_msgs::Header header = headerAt(frame.stamp_ns, frames::kOptical);
  bag.write(bag_topics::kCameraInfo, toCameraInfo(frame.camera, header), header.stamp);
  bag.write(bag_topics::kDepth, *toDepthImage(frame, header), header.stamp);
  bag.write(bag_topics::kColor, *toImage(frame.color, "rgb8", header), header.stamp);
}

void convert(pf::FrameSource& source, int max_frames, const std::string& out) {
  BagFile bag(out);
  const pf::RecordedPeople people = source.people();
  int written = 0, defects = 0;
  while (max_frames == 0 || written < max_frames) {
    const auto next = source.next();
    if (!next) break;
    if (!next->defect.empty()) {
      ++defects;
      std::cerr << "left out: " << next->defect << "\n";
      continue;
    }
    writeFrame(next->frame, bag);
    const auto found = people.find(next->frame.stamp_ns);
    if (found != people.end()) {
      const std_msgs::Header header = headerAt(found->first, frames::kOptical);
      bag.write(bag_topics::kPeople, toMessage(found->second, header), header.stamp);
    }
    ++written;
  }
  if (written == 0) throw InputError("the input has no frame that can be read");
  writeTruth(source.truth(), bag);
  bag.commit();
  std::cout << written << " frames in " << out;
  if (defects > 0) std::cout << ", " << defects << " left out";
  std::cout << "\n";
}

}  // namespace
}  // namespace posefusion_ros

int main(int argc, char** argv) {
  std::string input, camera_file, out;
  int max_frames = 0;
  pf::CommandLine app{
      "Writes a TUM folder as a ROS bag: colour, registered depth, camera_info, recorded people\n"
      "and true poses, under the names of openni2_launch.",
      "posefusion_to_bag"};
  app.addOption("tum_folder", input, "the recording")->required();
  app.addOption("bag", out, "new bag; one of that name is replaced")->required();
  app.addOption("--camera", camera_file, "camera of the folder, instead of its camera.yaml");
  app.addOption("--max-frames", max_frames, "stop after so many frames; 0: all")
      ->check(pf::nonNegative());
  return pf::runTool(app, argc, argv, [&] {
    posefusion_ros::convert(*pf::openTumFolder(input, camera_file), max_frames, out);
    return 0;
  });
}

// SPDX-License-Identifier: BSD-3-Clause
#include "new_bag.hpp"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "posefusion_ros/bags/conversions.hpp"

namespace pf {

std_msgs::Header headerAt(std::int64_t stamp_ns, const std::string& frame) {
  std_msgs::Header header;
  header.stamp = posefusion_ros::toTime(stamp_ns);
  header.frame_id = frame;
  return header;
}

NewBag::NewBag(const std::string& path)
    : path_(path), part_(path + ".part" + std::to_string(getpid())) {
  if (std::filesystem::exists(path_)) throw InputError(path + ": is there, expected a new bag");
  attempt([&] {
    bag_->open(part_, rosbag::bagmode::Write);
    bag_->setCompression(rosbag::compression::LZ4);
  });
}

NewBag::~NewBag() {
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

void NewBag::commit() {
  attempt([&] { bag_->close(); });
  std::error_code error;
  std::filesystem::rename(part_, path_, error);
  if (error) throw InputError(path_ + ": cannot be given its name: " + error.message());
  part_.clear();
}

}  // namespace pf

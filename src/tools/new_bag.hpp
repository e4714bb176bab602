// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>
#include <std_msgs/Header.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>

#include "posefusion/core/error.hpp"

namespace pf {

std_msgs::Header headerAt(std::int64_t stamp_ns, const std::string& frame);

/// A bag that gets its name when it is whole; an unfinished one is removed. All throws are
/// InputError naming the file.
class NewBag {
 public:
  /// Throws where something of that name is there.
  explicit NewBag(const std::string& path);
  ~NewBag();
  NewBag(const NewBag&) = delete;
  NewBag& operator=(const NewBag&) = delete;

  /// At the stamp of the header.
  template <typename Message>
  void write(const char* topic, const Message& message, const std_msgs::Header& header) {
    attempt([&] { bag_->write(topic, header.stamp, message); });
  }

  void commit();

 private:
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

  std::string path_;
  std::string part_;
  std::unique_ptr<rosbag::Bag> bag_ = std::make_unique<rosbag::Bag>();
};

}  // namespace pf

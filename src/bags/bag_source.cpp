// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/bags/bag_source.hpp"

#include <geometry_msgs/PoseStamped.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "bag_cameras.hpp"
#include "bag_topics.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "stamp_pairer.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;
using pf::SourceFrame;

/// Runs `read`, and turns what rosbag throws into an InputError that names the bag.
template <typename Read>
auto reading(const std::string& path, const Read& read) {
  const std::string advice = "; if it was cut or not closed, 'rosbag reindex " + path + "' helps";
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(path + ": the bag has no index" + advice);
  } catch (const std::exception& error) {
    throw InputError(path + ": the bag cannot be read: " + error.what() + advice);
  }
}

/// What a topic gives while its stamps grow.
struct Stream {
  std::int64_t latest_ns = std::numeric_limits<std::int64_t>::min();
  std::size_t going_back = 0;

  bool isFirst() const { return latest_ns == std::numeric_limits<std::int64_t>::min(); }

  bool accept(std::int64_t stamp_ns) {
    if (stamp_ns <= latest_ns) {
      ++going_back;
      return false;
    }
    latest_ns = stamp_ns;
    return true;
  }
};

// A stamp so far ahead of the one before is compared with those after it: it may be of the future.
// As live, see `time_jump_threshold_s`.
constexpr std::int64_t kJump_ns = 1'000'000'000;
constexpr int kCompared = 5;

class BagSource : public pf::FrameSource {
 public:
  BagSource(const std::string& path, const InputOptions& options)
      : path_(path),
        depth_offset_s_(options.depth_stamp_offset_s),
        pairer_(static_cast<std::int64_t>(std::llround(options.max_pair_difference_s * 1e9))) {
    reading(path_, [&] {
      bag_.open(path_, rosbag::bagmode::Read);
      topics_ = chooseTopics(topicsOf(bag_), options.topics);
      rosbag::View colors(bag_, rosbag::TopicQuery(topics_.color));
      frame_count_ = colors.size();
      if (frame_count_ == 0) throw InputError("topic " + topics_.color + " has no message");
      camera_ = recordedCamera(bag_, topics_, options.camera_file);
      view_.addQuery(bag_, rosbag::TopicQuery({topics_.color, topics_.depth}));
      position_ = view_.begin();
    });
  }

  std::size_t frameCount() const override { return frame_count_; }

  std::optional<SourceFrame> next() override {
    while (true) {
      if (auto pair = pairer_.next()) return decode(pair->first, pair->second);
      if (position_ == view_.end()) {
        if (finished_) return std::nullopt;
        finished_ = true;
        pairer_.finish();
        continue;
      }
      auto defect = reading(path_, [&] { return readMessage(); });
      if (defect) return defect;
    }
  }

  pf::RecordedPeople people() override {
    pf::RecordedPeople recorded;
    forEach<PeopleMsg>(topics_.people, [&](const PeopleMsg& message) {
      recorded[toNs(message.header.stamp)] = fromMessage(message);
    });
    return recorded;
  }

  std::optional<pf::ColorCamera> colorCamera() override { return camera_.beside; }
  pf::Trajectory truth() override {
    pf::Trajectory truth;
    forEach<geometry_msgs::PoseStamped>(topics_.truth, [&](const auto& message) {
      const auto& p = message.pose.position;
      const auto& q = message.pose.orientation;
      pf::StampedPose pose;
      pose.stamp_ns = toNs(message.header.stamp);
      pose.T_world_camera.translation() = Eigen::Vector3d(p.x, p.y, p.z);
      pose.T_world_camera.linear() =
          Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
      truth.push_back(pose);
    });
    std::stable_sort(truth.begin(), truth.end(),
                     [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
    return truth;
  }

  pf::InputReport report() const override {
    pf::InputReport report;
    report.color_without_depth = pairer_.unpairedFirst();
    report.depth_without_color = pairer_.unpairedSecond();
    if (depth_.going_back > 0) {
      report.notes.push_back(std::to_string(depth_.going_back) +
                             " depth images have stamps that go back: they are left out");
    }
    return report;
  }

 private:
  /// Takes in the next message; a colour image whose stamp goes back is a frame with a defect.
  std::optional<SourceFrame> readMessage() {
    const rosbag::MessageInstance message = *position_;
    const bool is_color = message.getTopic() == topics_.color;
    auto image = readImage(message, is_color ? 0.0 : depth_offset_s_);
    ++position_;
    if (!image) return std::nullopt;
    Stream& stream = is_color ? color_ : depth_;
    const bool jumps = !stream.isFirst() && image->stamp_ns - stream.latest_ns > kJump_ns;
    const bool is_stray = jumps && isAheadOfNext(message.getTopic(), *image, stream.latest_ns);
    const std::int64_t latest_ns = stream.latest_ns;
    if (!is_stray && stream.accept(image->stamp_ns)) {
      is_color ? pairer_.addFirst(std::move(*image)) : pairer_.addSecond(std::move(*image));
      return std::nullopt;
    }
    if (!is_color) return std::nullopt;
    SourceFrame out = emptyFrame(image->stamp_ns);
    out.defect = "stamp " + pf::formatStamp(image->stamp_ns) +
                 (is_stray ? " is later than those of the frames after it"
                           : " is not later than " + pf::formatStamp(latest_ns) + " before it");
    return out;
  }

  /// Whether the messages that follow on the topic go on from the one before this image.
  bool isAheadOfNext(const std::string& topic, const InputImage& image, std::int64_t before_ns) {
    int compared = 0;
    for (auto next = position_; next != view_.end() && compared < kCompared; ++next) {
      if (next->getTopic() != topic) continue;
      ++compared;
      const auto following = readImage(*next, topic == topics_.depth ? depth_offset_s_ : 0.0);
      if (!following) continue;
      if (following->stamp_ns > before_ns && following->stamp_ns < image.stamp_ns) return true;
    }
    return false;
  }

  SourceFrame emptyFrame(std::int64_t stamp_ns) const {
    SourceFrame out;
    out.frame.stamp_ns = stamp_ns;
    out.frame.camera = camera_.color;
    return out;
  }

  SourceFrame decode(const InputImage& color, const InputImage& depth) const {
    SourceFrame out = emptyFrame(color.stamp_ns);
    try {
      out.frame = toFrame(color, depth, camera_);
      // Pixels of a message are copied: they outlive it.
      for (cv::Mat* image : {&out.frame.color, &out.frame.depth}) {
        if (image->u == nullptr) *image = image->clone();
      }
    } catch (const std::exception& error) {
      out.defect = "frame " + pf::formatStamp(color.stamp_ns) + ": " + error.what();
    }
    return out;
  }

  template <typename Message, typename Use>
  void forEach(const std::string& topic, const Use& use) {
    if (topic.empty()) return;
    reading(path_, [&] {
      rosbag::View view(bag_, rosbag::TopicQuery(topic));
      for (const auto& instance : view) {
        const auto message = instance.template instantiate<Message>();
        if (!message) {
          throw InputError("topic " + topic + " has messages " + instance.getDataType() +
                           " of another version, expected the one of this posefusion");
        }
        use(*message);
      }
    });
  }

  std::string path_;
  rosbag::Bag bag_;
  BagTopics topics_;
  rosbag::View view_;
  rosbag::View::iterator position_;
  double depth_offset_s_;
  StampPairer<InputImage> pairer_;
  Stream color_, depth_;
  InputCamera camera_;
  std::size_t frame_count_ = 0;
  bool finished_ = false;
};

}  // namespace

std::unique_ptr<pf::FrameSource> openBag(const std::string& path, const InputOptions& options) {
  return std::make_unique<BagSource>(path, options);
}

std::unique_ptr<pf::FrameSource> openInput(const std::string& path, const InputOptions& options) {
  if (!std::filesystem::exists(path)) {
    throw InputError(path + ": does not exist, expected a TUM folder or a bag");
  }
  if (std::filesystem::is_directory(path)) {
    return pf::openTumFolder(path, options.camera_file);
  }
  return openBag(path, options);
}

std::string recordedFrameId(const std::string& path, const BagTopics& topics) {
  if (std::filesystem::is_directory(path)) return {};
  return reading(path, [&] {
    rosbag::Bag bag(path, rosbag::bagmode::Read);
    rosbag::View colors(bag, rosbag::TopicQuery(chooseTopics(topicsOf(bag), topics).color));
    if (colors.size() == 0) return std::string();
    const auto first = readImage(*colors.begin(), 0.0);
    return first ? first->header.frame_id : std::string();
  });
}

}  // namespace posefusion_ros

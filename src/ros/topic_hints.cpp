// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/topic_hints.hpp"

#include <ros/master.h>

#include <algorithm>
#include <set>

namespace posefusion_ros {
namespace {

/// "/camera/rgb/image_raw" as camera, rgb, image, raw.
std::set<std::string> partsOf(const std::string& name) {
  std::set<std::string> parts;
  std::string part;
  for (const char c : name + "/") {
    if (c != '/' && c != '_') {
      part += c;
    } else if (!part.empty()) {
      parts.insert(part);
      part.clear();
    }
  }
  return parts;
}

/// Parts that two names share, less those that only one has.
int likeness(const std::string& a, const std::string& b) {
  const auto one = partsOf(a), other = partsOf(b);
  const auto shared = static_cast<int>(std::count_if(
      one.begin(), one.end(), [&](const std::string& part) { return other.count(part) > 0; }));
  return 4 * shared - static_cast<int>(one.size() + other.size());
}

}  // namespace

std::string topicHint(const NamedType& wanted, const std::vector<NamedType>& published,
                      const std::string& own, std::size_t most) {
  const auto& [name, type] = wanted;
  std::vector<std::string> found;
  for (const auto& [other, its_type] : published) {
    if (other == name && its_type != type) return "; it is published as a " + its_type;
    const bool is_own = other.rfind(own + "/", 0) == 0;
    if (its_type == type && other != name && !is_own) found.push_back(other);
  }
  if (found.empty()) return "; no topic of type " + type + " is published";
  std::sort(found.begin(), found.end());
  std::stable_sort(found.begin(), found.end(), [&wanted](const auto& a, const auto& b) {
    return likeness(a, wanted.first) > likeness(b, wanted.first);
  });
  std::string text = "; of its type there are";
  for (std::size_t i = 0; i < std::min(most, found.size()); ++i) {
    text += (i == 0 ? " " : ", ") + found[i];
  }
  return text;
}

std::string topicHint(const NamedType& wanted, const std::string& own) {
  ros::master::V_TopicInfo topics;
  if (!ros::master::getTopics(topics)) return {};
  std::vector<NamedType> published;
  published.reserve(topics.size());
  for (const auto& topic : topics) published.emplace_back(topic.name, topic.datatype);
  return topicHint(wanted, published, own);
}

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/moving_objects_file.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

using nlohmann::ordered_json;

constexpr double kStep_m = 1e-4;  // finer is noise

ordered_json toJson(const Eigen::Vector3d& point) {
  if (!point.allFinite()) return nullptr;
  ordered_json numbers = ordered_json::array();
  for (int i = 0; i < 3; ++i) {  // Eigen 3.3 has no begin() of a vector
    numbers.push_back(std::round(point[i] / kStep_m) / std::round(1.0 / kStep_m));
  }
  return numbers;
}

ordered_json toJson(const MovingObject& object) {
  const Eigen::AlignedBox3d box_m = object.box_m();
  ordered_json out{{"id", object.id},
                   {"is_person", object.is_person},
                   {"centre", toJson(object.centre_m)},
                   {"box", {toJson(box_m.min()), toJson(box_m.max())}},
                   {"velocity", toJson(object.velocity_m_s)}};
  if (!object.is_person) return out;
  ordered_json& joints = out["joints"] = ordered_json::array();
  for (const Eigen::Vector3f& joint : object.joints_m)
    joints.push_back(toJson(joint.cast<double>()));
  return out;
}

}  // namespace

MovingObjectsFile::MovingObjectsFile(const std::string& path) : file_(path) {
  ordered_json names = ordered_json::array();
  for (const auto name : kJointNames) names.push_back(std::string(name));
  file_.stream() << "{\"joints\": " << names.dump() << ",\n \"frames\": [";
}

void MovingObjectsFile::add(std::int64_t stamp_ns, const std::vector<MovingObject>& objects) {
  if (objects.empty()) return;
  ordered_json listed = ordered_json::array();
  for (const MovingObject& object : objects) listed.push_back(toJson(object));
  const ordered_json frame{{"stamp", formatStamp(stamp_ns)}, {"objects", std::move(listed)}};
  file_.stream() << (has_frames_ ? ",\n  " : "\n  ") << frame.dump();
  has_frames_ = true;
}

void MovingObjectsFile::finish() {
  file_.stream() << "\n ]}\n";
  file_.commit();
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/surfel_cloud.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <cstring>

namespace posefusion_ros {
namespace {

constexpr const char* kFields[] = {"x",        "y",        "z",      "rgb",       "normal_x",
                                   "normal_y", "normal_z", "radius", "confidence"};
static_assert(sizeof(SurfelPoint) == sizeof(kFields) / sizeof(kFields[0]) * sizeof(float));

float packed(float r, float g, float b) {
  const auto byte = [](float value) {
    return static_cast<std::uint32_t>(std::lround(std::fmin(255.0F, std::fmax(0.0F, value))));
  };
  const std::uint32_t bits = byte(r) << 16 | byte(g) << 8 | byte(b);
  float rgb = 0;
  std::memcpy(&rgb, &bits, sizeof(rgb));
  return rgb;
}

void describe(sensor_msgs::PointCloud2& cloud) {
  for (const char* name : kFields) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(cloud.fields.size() * sizeof(float));
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.point_step = sizeof(SurfelPoint);
  cloud.height = 1;
  cloud.is_dense = 1;
}

}  // namespace

const SurfelPoint* surfelsOf(const sensor_msgs::PointCloud2& cloud) {
  sensor_msgs::PointCloud2 ours;
  describe(ours);
  const bool same = cloud.fields == ours.fields && cloud.point_step == ours.point_step &&
                    cloud.height == 1 && !cloud.is_bigendian &&
                    cloud.data.size() == std::size_t{cloud.width} * cloud.point_step;
  // The payload of a message is aligned for floats: it is an allocation of its own.
  return same ? reinterpret_cast<const SurfelPoint*>(cloud.data.data()) : nullptr;
}

sensor_msgs::PointCloud2::Ptr toCloud(const std::vector<SurfelPoint>& points) {
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  describe(*cloud);
  cloud->width = static_cast<std::uint32_t>(points.size());
  cloud->row_step = cloud->width * cloud->point_step;
  cloud->data.resize(points.size() * sizeof(SurfelPoint));
  if (!points.empty()) std::memcpy(cloud->data.data(), points.data(), cloud->data.size());
  return cloud;
}

sensor_msgs::PointCloud2::Ptr toCloud(const pf::SurfelMap& map,
                                      const Eigen::Isometry3d& T_map_start,
                                      std::size_t max_points) {
  const std::size_t stable = map.stableCount();
  const std::size_t step =
      max_points > 0 ? std::max<std::size_t>(1, (stable + max_points - 1) / max_points) : 1;
  const Eigen::Isometry3f T = T_map_start.cast<float>();
  std::vector<SurfelPoint> points;
  points.reserve(stable / step + 1);
  std::size_t seen = 0;
  map.forEachSurfelOf(pf::kFirstFragment, [&](const pf::SurfelArrays& s, std::size_t i) {
    if (!map.isStable(s, i) || seen++ % step != 0) return;
    const Eigen::Vector3f p = T * Eigen::Vector3f(s.x[i], s.y[i], s.z[i]);
    const Eigen::Vector3f n = T.linear() * Eigen::Vector3f(s.nx[i], s.ny[i], s.nz[i]);
    points.push_back({p.x(), p.y(), p.z(), packed(s.r[i], s.g[i], s.b[i]), n.x(), n.y(), n.z(),
                      s.radius[i], pf::static_odds::probability(s.odds[i])});
  });
  return toCloud(points);
}

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/surface_output.hpp"

#include <ros/console.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr float kPiece_m = 2;
constexpr char kMarkers[] = "mesh";
constexpr int kRests = 4;  // times as long as it worked
constexpr int kNice = 10;  // of the thread: frames come first
constexpr double kMemoryLimit_mb = 1024;

pf::MeshConfig meshConfig(const SurfaceOutputSettings& settings) {
  pf::MeshConfig config;
  config.cell_m = settings.mesh_cell_m;
  // Else vertices in the middle of large cells would be left out, far from any surfel.
  config.bridge_m = std::max(config.bridge_m, config.cell_m);
  config.memory_limit_mb = kMemoryLimit_mb;
  return config;
}

pf::GridConfig gridConfig(const SurfaceOutputSettings& settings) {
  pf::GridConfig config;
  config.cell_m = settings.grid_cell_m;
  return config;
}

float pieceSide(const SurfaceOutputSettings& settings) {
  return std::max(kPiece_m, static_cast<float>(10 * settings.mesh_cell_m));
}

void append(const Eigen::Vector3f& p, const pf::MeshColor& c, Marker& marker) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  std_msgs::ColorRGBA color;
  color.r = static_cast<float>(c[0]) / 255;
  color.g = static_cast<float>(c[1]) / 255;
  color.b = static_cast<float>(c[2]) / 255;
  color.a = 1;
  marker.points.push_back(point);
  marker.colors.push_back(color);
}

/// What goes wrong is said, and tried again when it is due next.
template <typename Task>
void tryTo(const char* what, const Task& task) {
  try {
    task();
  } catch (const std::exception& error) {  // no floor yet, no memory
    ROS_WARN_THROTTLE(30.0, "no %s is published: %s", what, error.what());
  }
}

Marker withoutAllBefore() {
  Marker marker;
  marker.ns = kMarkers;
  marker.action = Marker::DELETEALL;
  marker.pose.orientation.w = 1;
  return marker;
}

}  // namespace

SurfaceOutputSettings readSurfaceOutput(Parameters& parameters) {
  SurfaceOutputSettings s;
  s.mesh_cell_m = parameters.number("mesh_cell_m", s.mesh_cell_m, {0.01, 1.0});
  s.grid_cell_m = parameters.number("grid_cell_m", s.grid_cell_m, {0.01, 1.0});
  return s;
}

std::shared_ptr<const MapSnapshot> snapshotOf(const MappingSession& session,
                                              const std::optional<Eigen::Isometry3d>& T_map_start,
                                              const ros::Time& stamp) {
  if (!T_map_start) return nullptr;
  const pf::Mapper& mapper = session.mapper();
  return std::make_shared<const MapSnapshot>(MapSnapshot{
      mapper.map(), session.camera(), mapper.backEnd().graph().keyframes(), *T_map_start, stamp});
}

Marker toMarker(const pf::TriangleMesh& mesh, int id, const Eigen::Isometry3d& T_map_start) {
  Marker marker;
  marker.ns = kMarkers;
  marker.id = id;
  marker.type = Marker::TRIANGLE_LIST;
  marker.action = mesh.triangles.empty() ? Marker::DELETE : Marker::ADD;
  marker.pose = toPose(T_map_start);
  marker.scale.x = marker.scale.y = marker.scale.z = 1;
  marker.color.a = 1;
  marker.points.reserve(3 * mesh.triangles.size());
  marker.colors.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      append(mesh.positions[corner], mesh.colors[corner], marker);
    }
  }
  return marker;
}

nav_msgs::OccupancyGrid toMessage(const pf::OccupancyGrid& grid,
                                  const Eigen::Isometry3d& T_map_floor) {
  nav_msgs::OccupancyGrid message;
  message.info.resolution = static_cast<float>(grid.cell_m);
  message.info.width = static_cast<std::uint32_t>(grid.cells.cols);
  message.info.height = static_cast<std::uint32_t>(grid.cells.rows);
  message.info.origin = toPose(T_map_floor * Eigen::Translation3d(grid.low_x_m, grid.low_y_m, 0));
  message.data.assign(grid.cells.begin<std::int8_t>(), grid.cells.end<std::int8_t>());
  return message;
}

bool SurfaceOutput::Topic::isDue(const ros::Time& stamp, double period_s) const {
  if (publisher.getNumSubscribers() == 0) return false;
  if (is_new || sent.isZero() || stamp < sent) return true;
  return (stamp - sent).toSec() >= period_s && Clock::now() >= rest_until;
}

void SurfaceOutput::Topic::rest(Clock::time_point began) {
  const auto now = Clock::now();
  rest_until = now + kRests * (now - began);
}

SurfaceOutput::SurfaceOutput(ros::NodeHandle& handle, const SurfaceOutputSettings& settings,
                             const PublishingConfig& config, const std::string& map_frame,
                             std::function<void()> wants)
    : map_frame_(map_frame),
      config_(config),
      wants_(std::move(wants)),
      pieces_(meshConfig(settings), pieceSide(settings)),
      growing_(gridConfig(settings)) {
  worker_ = std::make_unique<Worker<JobPtr>>(0, [this](const JobPtr& job) { work(*job); });
  worker_->post([] { setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice); });
  const auto listener = [this](Topic& topic) {
    return [this, &topic](const ros::SingleSubscriberPublisher&) { listen(topic); };
  };
  const ros::SubscriberStatusCallback none;
  mesh_.publisher = handle.advertise<MarkerArray>(topics::kMesh, 1, listener(mesh_), none,
                                                  ros::VoidConstPtr(), true);
  grid_.publisher = handle.advertise<nav_msgs::OccupancyGrid>(topics::kGrid, 1, listener(grid_),
                                                              none, ros::VoidConstPtr(), true);
}

void SurfaceOutput::close() {
  is_closing_ = true;
  mesh_.publisher.shutdown();
  grid_.publisher.shutdown();
  worker_->stop();
}

void SurfaceOutput::listen(Topic& topic) {
  topic.is_new = true;
  if (!is_closing_) wants_();
}

void SurfaceOutput::reset() {
  is_other_map_ = true;
  restartClock();
}

void SurfaceOutput::restartClock() { mesh_.sent = grid_.sent = ros::Time(); }

void SurfaceOutput::offer(const ros::Time& stamp, const Taker& take) {
  if (is_busy_ || is_closing_) return;
  Job job;
  job.mesh = mesh_.isDue(stamp, config_.mesh_period_s);
  job.grid = grid_.isDue(stamp, config_.grid_period_s);
  if (!job.mesh && !job.grid) return;
  job.snapshot = take(stamp);
  if (!job.snapshot) return;
  is_busy_ = true;
  job.is_other_map = std::exchange(is_other_map_, false);
  if (job.mesh) {
    job.all = mesh_.is_new.exchange(false);
    mesh_.sent = stamp;
  }
  if (job.grid) {
    grid_.is_new = false;
    grid_.sent = stamp;
  }
  worker_->push(std::make_shared<const Job>(std::move(job)));
}

void SurfaceOutput::work(const Job& job) {
  // Alone: the threads that parallel loops share belong to the frames.
  tbb::task_arena alone(1);
  if (job.is_other_map) growing_ = pf::GrowingGrid(growing_.config());
  alone.execute([&] {
    if (job.mesh) tryTo("mesh", [&] { publishMesh(job); });
    if (job.grid) tryTo("grid", [&] { publishGrid(job); });
  });
  is_busy_ = false;
  if ((mesh_.is_new || grid_.is_new) && !is_closing_) wants_();
}

void SurfaceOutput::publishMesh(const Job& job) {
  const auto began = Clock::now();
  const bool all = job.all || job.is_other_map;
  if (all) pieces_.forget();
  const MapSnapshot& from = *job.snapshot;
  MarkerArray message;
  if (all) message.markers.push_back(withoutAllBefore());
  for (const auto& piece : pieces_.update(from.map, [this] { return is_closing_.load(); })) {
    const int id = ids_.emplace(piece.key, static_cast<int>(ids_.size())).first->second;
    message.markers.push_back(toMarker(piece.mesh, id, from.T_map_start));
  }
  for (Marker& marker : message.markers) {
    marker.header.stamp = from.stamp;
    marker.header.frame_id = map_frame_;
  }
  if (!message.markers.empty() && !is_closing_) mesh_.publisher.publish(message);
  mesh_.rest(began);
}

void SurfaceOutput::publishGrid(const Job& job) {
  const auto began = Clock::now();
  const MapSnapshot& from = *job.snapshot;
  const auto placed = growing_.update({from.map, from.camera, from.keyframes, from.T_map_start},
                                      [this] { return is_closing_.load(); });
  if (placed) {
    nav_msgs::OccupancyGrid message = toMessage(placed->grid, placed->T_world_floor);
    message.header.stamp = message.info.map_load_time = from.stamp;
    message.header.frame_id = map_frame_;
    grid_.publisher.publish(message);
  }
  grid_.rest(began);
}

}  // namespace posefusion_ros

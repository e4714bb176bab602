// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/OccupancyGrid.h>
#include <ros/node_handle.h>
#include <visualization_msgs/MarkerArray.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/grid/floor_map.hpp"
#include "posefusion/mesh/mesh_pieces.hpp"
#include "posefusion_ros/mapping_session.hpp"
#include "posefusion_ros/parameters.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/worker.hpp"

namespace posefusion_ros {

/// How fine mesh and grid are that are published.
struct SurfaceOutputSettings {
  double mesh_cell_m = 0.05, grid_cell_m = 0.05;
};

/// Reads `mesh_cell_m` and `grid_cell_m`.
SurfaceOutputSettings readSurfaceOutput(Parameters& parameters);

/// A map as it was between two frames; shares its surfels until either changes.
struct MapSnapshot {
  pf::SurfelMap map;
  pf::PinholeCamera camera;  ///< of the frames
  std::vector<pf::Keyframe> keyframes;
  Eigen::Isometry3d T_map_start;  ///< the core's map in the map frame
  ros::Time stamp;
};

/// Null while the map frame is not known.
std::shared_ptr<const MapSnapshot> snapshotOf(const MappingSession& session,
                                              const std::optional<Eigen::Isometry3d>& T_map_start,
                                              const ros::Time& stamp);

/// The piece of a mesh as a list of triangles, its points in the core's map; to be taken away where
/// it has none.
visualization_msgs::Marker toMarker(const pf::TriangleMesh& mesh, int id,
                                    const Eigen::Isometry3d& T_map_start);

/// `T_map_floor`: from the frame of the grid to the map frame.
nav_msgs::OccupancyGrid toMessage(const pf::OccupancyGrid& grid,
                                  const Eigen::Isometry3d& T_map_floor);

/// Publishes the map as a mesh, piece by piece where it has changed, and as a grid, while someone
/// listens. They are made of a snapshot in a thread of its own that comes after the others, and
/// takes at most a fifth of its time: no frame waits for it.
class SurfaceOutput {
 public:
  /// Takes a snapshot; null while the map frame is not known.
  using Taker = std::function<std::shared_ptr<const MapSnapshot>(const ros::Time& stamp)>;

  /// `wants`: called, in some thread, when offer() should be called though no frame has come:
  /// someone has begun to listen.
  SurfaceOutput(ros::NodeHandle& handle, const SurfaceOutputSettings& settings,
                const PublishingConfig& config, const std::string& map_frame,
                std::function<void()> wants);
  ~SurfaceOutput() { close(); }

  /// No more messages, and no call of `wants` once this has returned. Waits for the piece at hand.
  void close();

  /// Between two frames: takes a snapshot, where something is due, and nothing in work.
  void offer(const ros::Time& stamp, const Taker& take);

  /// From the next offer on. @{
  void set(const PublishingConfig& config) { config_ = config; }
  void reset();         ///< another map
  void restartClock();  ///< the map goes on, stamps may begin anew
                        /// @}

 private:
  using Clock = std::chrono::steady_clock;

  /// One of the two topics.
  struct Topic {
    ros::Publisher publisher;
    std::atomic<bool> is_new{false};  ///< someone has not had all of it
    ros::Time sent;
    Clock::time_point rest_until{};  ///< until then the thread does other things

    bool isDue(const ros::Time& stamp, double period_s) const;
    /// Remembers how long it took.
    void rest(Clock::time_point began);
  };
  struct Job {
    std::shared_ptr<const MapSnapshot> snapshot;
    bool is_other_map = false, mesh = false, all = false, grid = false;
  };
  using JobPtr = std::shared_ptr<const Job>;

  void listen(Topic& topic);
  void work(const Job& job);
  void publishMesh(const Job& job);
  void publishGrid(const Job& job);

  std::string map_frame_;
  PublishingConfig config_;
  std::function<void()> wants_;
  Topic mesh_, grid_;
  std::atomic<bool> is_busy_{false}, is_closing_{false};
  bool is_other_map_ = false;
  // Of the worker.
  pf::MeshPieces pieces_;
  std::map<pf::MeshPieces::Key, int> ids_;
  pf::GrowingGrid growing_;
  std::unique_ptr<Worker<JobPtr>> worker_;
};

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "posefusion/segmentation/moving_object.hpp"
#include "posefusion/segmentation/seen_before.hpp"

namespace pf {

/// What is known of a frame before its moving objects are searched.
struct MovingScene {
  const SceneGrid& grid;
  const PinholeCamera& camera;                    ///< of the frame
  const ModelView& view;                          ///< the map from the last trusted pose
  const Eigen::Isometry3d& T_uncorrected_camera;  ///< of the frame, as far as known
  const std::vector<Background>& background;      ///< how the cells agree with the map
  const std::vector<std::uint8_t>& is_person;     ///< cells that are taken out anyway
  std::int64_t stamp_ns;
};

/// Finds moving objects where depth contradicts the map and the frames of the last second: pieces
/// in front of the map in places that were empty a moment ago. Each is tracked, and the odds that
/// it moves are added up (a sequential test, Wald 1945): an object at rest for a while becomes
/// static again. After the idea of StaticFusion (Scona et al. 2018) and of Co-Fusion (Ruenz and
/// Agapito 2017). Not thread safe.
class MovingObjects {
 public:
  explicit MovingObjects(const DepthSensor& sensor);
  ~MovingObjects();

  /// Before find(): the object (any number) that each cell is expected to be of, -1: none.
  const std::vector<std::int16_t>& expect(const MovingScene& scene);

  /// After expect(): the objects seen in the frame, those at rest for a moment among them, in
  /// uncorrected coordinates (see ModelView).
  std::vector<MovingObject> find(const MovingScene& scene);

  /// After expect(): whether a cell shows what has stood there for a second.
  bool stood(int cell) const { return before_.stood(cell); }

  /// 1 = a cell of an object that moves, as of the last find().
  const std::vector<std::uint8_t>& labels() const { return labels_; }

  /// The camera's place is unknown: all objects are forgotten.
  void reset();

 private:
  struct Piece;
  struct Followed;
  void findOpenCells(const MovingScene& scene);
  void findSeeds(const MovingScene& scene);
  bool isOfMoving(const MovingScene& scene, int cell) const;
  std::vector<Piece> grow(const MovingScene& scene);
  Piece growFrom(const MovingScene& scene, int first);
  double evidenceOf(const Piece& piece) const;
  void follow(const MovingScene& scene, std::vector<Piece>& pieces, double elapsed_s);
  static void place(const MovingScene& scene, double elapsed_s, Piece& piece, Followed& object);

  DepthSensor sensor_;
  SeenBefore before_;
  std::vector<Followed> objects_;
  std::vector<std::uint8_t> labels_;
  std::vector<int> open_;               // cells that may be of something that moves
  std::vector<std::uint8_t> seeds_;     // 1: the place was empty a moment ago
  std::vector<std::int16_t> carried_;   // object that the cell should be of, -1: none
  std::vector<std::int32_t> piece_of_;  // while pieces grow; -1: none
  int last_id_ = 0;
  std::int64_t last_ns_ = 0;
};

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/keyframe.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/tracking/normal_equations.hpp"

namespace pf {

/// What a keyframe saw.
struct KeyframeImages {
  int keyframe = -1;
  cv::Mat grey;      ///< CV_8UC1
  cv::Mat depth_mm;  ///< CV_16UC1, 0 = none
};

/// All of a map but surfels and images.
struct MapContent {
  PinholeCamera camera;   ///< of the frames
  std::string settings;   ///< YAML, as toYaml() writes it
  Brightness brightness;  ///< of the map
  int frame = -1;         ///< SurfelMap::frame()
  int graph_version = 0;
  std::vector<Keyframe> keyframes;
  std::vector<PoseConstraint> constraints;
  std::vector<FrameRecord> frames;           ///< trajectory
  std::map<std::string, std::string> blobs;  ///< whatever a part of the program keeps, by its name
};

/// A block of surfels by its place in SurfelMap::blocks().
struct BlockRecord {
  std::uint32_t index = 0;
  int fragment = kFirstFragment;
  std::shared_ptr<const SurfelArrays> surfels;
};

/// The blocks changed in or after a frame, shared with the map; -1: all.
std::vector<BlockRecord> changedBlocks(const SurfelMap& map, int since_frame);

/// What one write brings: keyframes and constraints are all there are (only those that differ are
/// written); frames, blocks, images and blobs are new or changed ones.
struct MapUpdate : MapContent {
  std::uint32_t block_count = 0;  ///< of the map: stored ones from here on are removed
  std::vector<BlockRecord> blocks;
  std::vector<KeyframeImages> images;
};

/// Writes a map file, `*.pfdb`: one SQLite database (docs/algorithm-graph.md). No other process can
/// open it meanwhile. A process that dies leaves what the last whole write() brought, in the file
/// and the log beside it (`*.pfdb-wal`); without the log, what the write() before brought. Not
/// thread safe, but may be used from any one thread.
class MapWriter {
 public:
  enum class Mode {
    create,  ///< the file must not exist
    extend   ///< the file must be a map; the first write() must bring all blocks, and makes a file
             ///< of an older version one of the present version
  };

  /// Throws InputError naming the file.
  MapWriter(const std::string& path, Mode mode);
  /// Leaves one file without companions.
  ~MapWriter();
  MapWriter(const MapWriter&) = delete;
  MapWriter& operator=(const MapWriter&) = delete;

  /// All of it or, when it throws InputError (disk full), nothing; may be tried again.
  void write(const MapUpdate& update);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What becomes of a closed map that has the name already.
enum class IfThere { keep, replace };

/// Gives a closed map file another name. Throws InputError naming the file, and leaves both as they
/// are, where `from` was not closed, a log lies at `to`, or, to be kept, anything.
void renameMapFile(const std::string& from, const std::string& to, IfThere other = IfThere::keep);

/// How much a map file holds.
struct MapCounts {
  std::size_t blocks = 0, surfels = 0, images = 0, bytes = 0;
};

/// Reads a map file, of this version or an older one, without changing it.
class MapReader {
 public:
  /// Throws InputError naming the file when it is no map, damaged, of a newer version or in use.
  explicit MapReader(const std::string& path);
  ~MapReader();
  MapReader(const MapReader&) = delete;
  MapReader& operator=(const MapReader&) = delete;

  /// Each throws InputError naming the file and what in it cannot be.
  MapContent content() const;
  std::vector<FragmentSurfels> surfels() const;  ///< block by block, as SurfelMap::parts()
  /// Both images are empty when none are stored.
  KeyframeImages images(int keyframe) const;
  MapCounts counts() const;

  /// Why the newest of what was written may not be there; empty where all of it is. A map that was
  /// not closed has it in its log, which is lost where the file was copied or renamed without it.
  const std::string& missing() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf

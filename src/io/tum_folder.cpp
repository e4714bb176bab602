// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <limits>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/camera_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/known_cameras.hpp"
#include "posefusion/io/people_json.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxPairDifference_ns = 20'000'000;

struct Entry {
  std::int64_t stamp_ns = 0;
  std::string color;
  std::string depth;
};

/// A line of a list.
struct Row {
  std::string place;  ///< file and line
  std::vector<std::string> words;

  std::int64_t stamp(std::size_t column) const {
    try {
      return parseStamp(words[column]);
    } catch (const InputError& error) {
      throw InputError(place + ": " + error.what());
    }
  }
};

/// The lines that are no comment. Throws naming file and line when one has fewer than `columns`
/// words.
std::vector<Row> readRows(const fs::path& path, std::size_t columns) {
  std::istringstream file(readFile(path));
  std::vector<Row> rows;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    Row row{path.string() + ":" + std::to_string(number), {}};
    for (std::string word; words >> word;) row.words.push_back(word);
    if (row.words.empty() || row.words[0][0] == '#') continue;
    if (row.words.size() < columns) {
      throw InputError(row.place + ": expected " + std::to_string(columns) + " columns");
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Entry> readAssociations(const fs::path& path) {
  std::vector<Entry> entries;
  for (const Row& row : readRows(path, 4)) {
    // Some tools write depth first.
    const bool depth_first = row.words[1].rfind("depth", 0) == 0;
    const std::size_t color = depth_first ? 2 : 0, depth = depth_first ? 0 : 2;
    entries.push_back({row.stamp(color), row.words[color + 1], row.words[depth + 1]});
  }
  return entries;
}

std::vector<Entry> matchLists(const fs::path& folder, InputReport& report) {
  std::vector<std::int64_t> color_stamps, depth_stamps;
  const auto color = readRows(folder / "rgb.txt", 2);
  const auto depth = readRows(folder / "depth.txt", 2);
  for (const Row& row : color) color_stamps.push_back(row.stamp(0));
  for (const Row& row : depth) depth_stamps.push_back(row.stamp(0));
  std::vector<Entry> entries;
  for (const auto& [c, d] : matchStamps(color_stamps, depth_stamps, kMaxPairDifference_ns)) {
    entries.push_back({color_stamps[c], color[c].words[1], depth[d].words[1]});
  }
  report.color_without_depth = color.size() - entries.size();
  report.depth_without_color = depth.size() - entries.size();
  return entries;
}

/// The pairs that the lists of a folder name. Throws InputError when there are none.
std::vector<Entry> readEntries(const fs::path& folder, InputReport& report) {
  if (!fs::is_directory(folder)) throw InputError(folder.string() + ": is no folder");
  const bool lists = fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt");
  std::vector<Entry> entries;
  if (fs::exists(folder / "associations.txt")) {
    entries = readAssociations(folder / "associations.txt");
  } else if (lists) {
    entries = matchLists(folder, report);
  } else {
    throw InputError(folder.string() +
                     ": is no TUM folder, expected associations.txt, or rgb.txt and depth.txt in "
                     "it");
  }
  if (entries.empty()) {
    throw InputError(folder.string() + ": lists no pair of a colour and a depth image");
  }
  return entries;
}

std::vector<std::int64_t> stampsOf(const std::vector<Entry>& entries) {
  std::vector<std::int64_t> stamps_ns;
  for (const Entry& entry : entries) stamps_ns.push_back(entry.stamp_ns);
  return stamps_ns;
}

class TumFolder : public FrameSource {
 public:
  TumFolder(const std::string& folder, const std::string& camera_file) : folder_(folder) {
    entries_ = readEntries(folder_, report_);
    rising_ = risingStamps(stampsOf(entries_));
    readCamera(camera_file);
  }

  std::size_t frameCount() const override { return entries_.size(); }

  std::optional<SourceFrame> next() override {
    if (position_ == entries_.size()) return std::nullopt;
    const Entry& entry = entries_[position_++];
    SourceFrame out;
    out.frame.stamp_ns = entry.stamp_ns;
    out.frame.camera = camera_;
    out.frame.depth_unit_m = depth_unit_m_;
    if (!rising_[position_ - 1]) {
      const bool is_late = entry.stamp_ns <= latest_stamp_ns_;
      out.defect = "stamp " + formatStamp(entry.stamp_ns) +
                   (is_late ? " is not later than " + formatStamp(latest_stamp_ns_) + " before it"
                            : " is later than those of the frames after it");
      return out;
    }
    latest_stamp_ns_ = entry.stamp_ns;
    readImages(entry, out);
    return out;
  }

  RecordedPeople people() override {
    const fs::path path = folder_ / "people.json";
    return fs::exists(path) ? loadPeople(path) : RecordedPeople{};
  }

  Trajectory truth() override {
    const fs::path path = folder_ / "groundtruth.txt";
    return fs::exists(path) ? loadTrajectory(path) : Trajectory{};
  }

  std::string sensorKind() const override { return sensor_kind_; }
  std::optional<ColorCamera> colorCamera() override { return color_camera_; }

  InputReport report() const override { return report_; }

 private:
  void readCamera(const std::string& camera_file) {
    const fs::path path = camera_file.empty() ? folder_ / "camera.yaml" : fs::path(camera_file);
    const auto known = knownCamera(folder_.string());
    if (camera_file.empty() && !fs::exists(path) && known) {
      take(known->file, known->recorded_by);
      report_.notes.push_back("there is no camera.yaml: the camera is that of " +
                              known->recorded_by + ", by the folder's name");
      return;
    }
    if (!fs::exists(path)) {
      throw InputError(path.string() +
                       ": is missing, expected the camera (width height fx fy cx cy "
                       "depth_factor); another file can be given by --camera");
    }
    take(loadCamera(path), path.string());
  }

  /// `origin`: for people.
  void take(const CameraFile& file, const std::string& origin) {
    if (!file.depth_factor) {
      throw InputError(origin +
                       ": depth_factor is missing, expected steps of the depth in a "
                       "metre (1000 for millimetres, 5000 for the TUM benchmark)");
    }
    camera_ = file.camera;
    sensor_kind_ = file.sensor_kind;
    color_camera_ = file.color;
    depth_unit_m_ = 1.0 / *file.depth_factor;
  }

  void readImages(const Entry& entry, SourceFrame& out) const {
    RgbdFrame& frame = out.frame;
    try {
      const std::string color = readFile(folder_ / entry.color);
      const std::string depth = readFile(folder_ / entry.depth);
      frame.color = decodeColor(color.data(), color.size());
      frame.depth = decodeDepth(depth.data(), depth.size());
      if (frame.color.empty()) throw InputError(entry.color + ": is not a whole image");
      if (frame.depth.empty()) throw InputError(entry.depth + ": is not a whole image");
      const std::string defect = defectOf(frame);
      if (!defect.empty()) throw InputError(entry.color + ", " + entry.depth + ": " + defect);
      return;
    } catch (const InputError& error) {
      out.defect = error.what();
    }
    frame.color.release();
    frame.depth.release();
  }

  fs::path folder_;
  std::vector<Entry> entries_;
  std::vector<bool> rising_;  ///< of each entry: its stamp is to be believed
  std::size_t position_ = 0;
  std::int64_t latest_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  PinholeCamera camera_;
  double depth_unit_m_ = 1e-3;
  std::string sensor_kind_;
  std::optional<ColorCamera> color_camera_;
  InputReport report_;
};

}  // namespace

std::unique_ptr<FrameSource> openTumFolder(const std::string& folder,
                                           const std::string& camera_file) {
  return std::make_unique<TumFolder>(folder, camera_file);
}

std::vector<std::int64_t> listTumFrames(const std::string& folder) {
  InputReport report;
  return stampsOf(readEntries(folder, report));
}

}  // namespace pf

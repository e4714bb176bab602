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

/// The words of each line that is no comment. Throws naming file and line when there are fewer than
/// `columns`.
std::vector<std::vector<std::string>> readColumns(const fs::path& path, std::size_t columns) {
  std::istringstream file(readFile(path));
  std::vector<std::vector<std::string>> rows;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<std::string> row;
    for (std::string word; words >> word;) row.push_back(word);
    if (row.empty() || row[0][0] == '#') continue;
    if (row.size() < columns) {
      throw InputError(path.string() + ":" + std::to_string(number) + ": expected " +
                       std::to_string(columns) + " columns");
    }
    rows.push_back(row);
  }
  return rows;
}

std::vector<Entry> readAssociations(const fs::path& path) {
  std::vector<Entry> entries;
  for (const auto& row : readColumns(path, 4)) {
    // Some tools write depth first.
    const bool depth_first = row[1].rfind("depth", 0) == 0;
    entries.push_back(
        {parseStamp(row[depth_first ? 2 : 0]), row[depth_first ? 3 : 1], row[depth_first ? 1 : 3]});
  }
  return entries;
}

std::vector<Entry> matchLists(const fs::path& folder, InputReport& report) {
  std::vector<std::int64_t> color_stamps, depth_stamps;
  const auto color = readColumns(folder / "rgb.txt", 2);
  const auto depth = readColumns(folder / "depth.txt", 2);
  for (const auto& row : color) color_stamps.push_back(parseStamp(row[0]));
  for (const auto& row : depth) depth_stamps.push_back(parseStamp(row[0]));
  std::vector<Entry> entries;
  for (const auto& [c, d] : matchStamps(color_stamps, depth_stamps, kMaxPairDifference_ns)) {
    entries.push_back({color_stamps[c], color[c][1], depth[d][1]});
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

class TumFolder : public FrameSource {
 public:
  TumFolder(const std::string& folder, const std::string& camera_file) : folder_(folder) {
    entries_ = readEntries(folder_, report_);
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
    if (entry.stamp_ns <= latest_stamp_ns_) {
      out.defect = "stamp " + formatStamp(entry.stamp_ns) + " is not later than " +
                   formatStamp(latest_stamp_ns_) + " before it";
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

  InputReport report() const override { return report_; }

 private:
  void readCamera(const std::string& camera_file) {
    const fs::path path = camera_file.empty() ? folder_ / "camera.yaml" : fs::path(camera_file);
    if (!fs::exists(path)) {
      throw InputError(path.string() +
                       ": is missing, expected the camera (width height fx fy cx cy "
                       "depth_factor); another file can be given by --camera");
    }
    const CameraFile file = loadCamera(path);
    if (!file.depth_factor) {
      throw InputError(path.string() +
                       ": depth_factor is missing, expected steps of the depth in a "
                       "metre (1000 for millimetres, 5000 for the TUM benchmark)");
    }
    camera_ = file.camera;
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
  std::size_t position_ = 0;
  std::int64_t latest_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  PinholeCamera camera_;
  double depth_unit_m_ = 1e-3;
  InputReport report_;
};

}  // namespace

std::unique_ptr<FrameSource> openTumFolder(const std::string& folder,
                                           const std::string& camera_file) {
  return std::make_unique<TumFolder>(folder, camera_file);
}

std::vector<std::int64_t> listTumFrames(const std::string& folder) {
  InputReport report;
  std::vector<std::int64_t> stamps_ns;
  for (const Entry& entry : readEntries(folder, report)) stamps_ns.push_back(entry.stamp_ns);
  return stamps_ns;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/mask_folders.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/frame.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/people_json.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

/// <stamp>.png files by their stamps in microseconds.
using Masks = std::map<std::int64_t, std::string>;

Masks listMasks(const fs::path& folder) {
  Masks masks;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".png") continue;
    try {
      const double seconds = std::stod(entry.path().stem().string());
      masks[std::llround(seconds * 1e6)] = entry.path().string();
    } catch (const std::exception&) {
      continue;  // another picture
    }
  }
  return masks;
}

fs::path maskFolderOf(const std::string& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder + ": no such folder of masks");
  const fs::path inner = fs::path(folder) / "mask";
  return fs::is_directory(inner) ? inner : fs::path(folder);
}

cv::Mat readMask(const std::string& path) {
  cv::Mat mask = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (mask.empty()) throw InputError(path + ": not a readable mask");
  return mask;
}

/// Where the masks lie.
struct MaskFiles {
  Masks truths, masks;
};

/// Goes through the sequence for its depth and checks the people that were found.
void checkFound(const std::string& sequence, const std::string& people_file, const MaskFiles& files,
                MaskCheck& check) {
  const auto& [truths, masks] = files;
  const RecordedPeople people = loadPeople(people_file);
  const auto source = openTumFolder(sequence);
  while (auto next = source->next()) {
    const auto seen = people.find(next->frame.stamp_ns);
    const std::int64_t stamp = next->frame.stamp_ns / 1000;
    const auto truth_file = truths.find(stamp), mask_file = masks.find(stamp);
    if (!next->defect.empty() || seen == people.end() || truth_file == truths.end() ||
        mask_file == masks.end()) {
      continue;
    }
    cv::Mat depth_m;
    depthInMetres(next->frame, 0.1, 20.0, depth_m);
    const cv::Mat truth = readMask(truth_file->second);
    check.addFound(truth, readMask(mask_file->second), foundParts(truth, depth_m, seen->second));
  }
}

}  // namespace

MaskCheck checkMasks(const std::string& truth_folder, const std::string& mask_folder) {
  const fs::path truth_masks = maskFolderOf(truth_folder);
  const MaskFiles files{listMasks(truth_masks), listMasks(maskFolderOf(mask_folder))};
  const auto& [truths, masks] = files;
  const bool is_sequence = fs::exists(fs::path(truth_folder) / "rgb.txt") ||
                           fs::exists(fs::path(truth_folder) / "associations.txt");
  if (truths.empty() && !is_sequence) {
    throw InputError(truth_folder + ": neither <stamp>.png masks nor a sequence");
  }
  if (masks.empty())
    throw InputError(mask_folder + ": no <stamp>.png masks (run with --save-masks)");
  MaskCheck check;
  for (const auto& [stamp, path] : masks) {
    const cv::Mat mask = readMask(path);
    const auto truth = truths.find(stamp);
    if (truth == truths.end() && !truths.empty()) continue;
    check.add(
        truths.empty() ? cv::Mat(mask.size(), CV_8UC1, cv::Scalar(0)) : readMask(truth->second),
        mask);
  }
  if (check.frames() == 0) {
    throw InputError(mask_folder + ": no mask has a stamp of " + truth_masks.string());
  }
  for (const fs::path& people :
       {fs::path(mask_folder) / "people.json", fs::path(mask_folder) / ".." / "people.json"}) {
    if (!fs::exists(people) || !is_sequence || truths.empty()) continue;
    checkFound(truth_folder, people.string(), files, check);
    break;
  }
  return check;
}

ThingMaskScore checkThingMasks(const std::string& sequence, const std::string& run) {
  const fs::path folder(sequence);
  for (const char* part : {"mask", "thing_mask"}) {
    if (!fs::is_directory(folder / part)) {
      throw InputError((folder / part).string() + ": no such folder of masks");
    }
  }
  const Masks people = listMasks(folder / "mask"), things = listMasks(folder / "thing_mask");
  ThingMaskScore score;
  double moving = 0, still = 0;
  for (const auto& [stamp, path] : listMasks(maskFolderOf(run))) {
    const auto person = people.find(stamp), thing = things.find(stamp);
    if (person == people.end() || thing == things.end()) continue;
    const cv::Mat mask = readMask(path) > 0, moves = readMask(thing->second) > 0;
    if (mask.size() != moves.size()) throw InputError(path + ": of another size than the truth");
    const cv::Mat stands = ~(moves | (readMask(person->second) > 0));
    ++score.frames;
    moving += cv::countNonZero(moves);
    still += cv::countNonZero(stands);
    score.masked_things += cv::countNonZero(mask & moves);
    score.masked_still += cv::countNonZero(mask & stands);
  }
  if (score.frames == 0) throw InputError(run + ": no mask has a stamp of " + sequence);
  score.masked_things /= std::max(1.0, moving);
  score.masked_still /= std::max(1.0, still);
  return score;
}

cv::Mat loadMask(const std::string& folder, std::int64_t stamp_ns) {
  const std::string path = folder + "/" + formatStamp(stamp_ns) + ".png";
  return fs::exists(path) ? readMask(path) : cv::Mat();
}

}  // namespace pf

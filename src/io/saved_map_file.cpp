// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/saved_map_file.hpp"

#include <cstring>
#include <memory>
#include <utility>

#include "map_encoding.hpp"
#include "posefusion/config/yaml_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/io/calibration_file.hpp"

namespace pf {
namespace {

// With the time that a write takes, less than a second is lost.
constexpr std::chrono::milliseconds kPeriod{500};

// Name of the blob that holds Mapper::placed().
constexpr char kPlace[] = "T_world_map";
constexpr char kCalibration[] = "calibration";

constexpr std::size_t kPixels = std::size_t{Thumbnail::kWidth} * Thumbnail::kHeight;
constexpr std::size_t kThumbnailBytes = 1 + kPixels * (3 + sizeof(float));

std::string encodeThumbnail(const KeyframeView& view) {
  std::string bytes(1, view.nobody_in_view ? '\1' : '\0');
  const Thumbnail& small = view.thumbnail;
  bytes.append(reinterpret_cast<const char*>(small.color.data), 3 * kPixels);
  bytes.append(reinterpret_cast<const char*>(small.depth_m.data), sizeof(float) * kPixels);
  return bytes;
}

void decodeThumbnail(const std::string& bytes, KeyframeView& view) {
  const cv::Size size(Thumbnail::kWidth, Thumbnail::kHeight);
  view.nobody_in_view = bytes[0] != '\0';
  view.thumbnail.color.create(size, CV_8UC3);
  view.thumbnail.depth_m.create(size, CV_32FC1);
  std::memcpy(view.thumbnail.color.data, bytes.data() + 1, 3 * kPixels);
  std::memcpy(view.thumbnail.depth_m.data, bytes.data() + 1 + 3 * kPixels, sizeof(float) * kPixels);
  if (cv::checkRange(view.thumbnail.depth_m, true, nullptr, 0.0, 1000.0)) return;
  throw InputError("the small picture of keyframe " + std::to_string(view.id) +
                   " has depths that cannot be");
}

std::vector<KeyframeView> readViews(const MapReader& reader, const MapContent& content) {
  std::vector<KeyframeView> views;
  for (const Keyframe& keyframe : content.keyframes) {
    const auto blob = content.blobs.find(keyframeBlob(keyframe.id));
    const KeyframeImages images = reader.images(keyframe.id);
    if (blob == content.blobs.end() || images.grey.empty()) continue;
    KeyframeView view;
    view.id = keyframe.id;
    view.pose = {keyframe.fragment, keyframe.T_map_camera};
    view.intensity = images.grey;
    view.depth_mm = images.depth_mm;
    if (blob->second.size() != kThumbnailBytes) {
      throw InputError("the small picture of keyframe " + std::to_string(view.id) + " has " +
                       std::to_string(blob->second.size()) + " bytes, expected " +
                       std::to_string(kThumbnailBytes));
    }
    decodeThumbnail(blob->second, view);
    views.push_back(std::move(view));
  }
  return views;
}

SavedMap savedMap(const MapReader& reader) {
  MapContent content = reader.content();
  SavedMap map;
  map.T_world_map = placeOf(content);
  map.calibration = calibrationOf(content);
  map.camera = content.camera;
  map.brightness = content.brightness;
  map.surfels = reader.surfels();
  map.frame = content.frame;
  map.views = readViews(reader, content);
  map.keyframes = std::move(content.keyframes);
  map.constraints = std::move(content.constraints);
  map.graph_version = content.graph_version;
  map.frames = std::move(content.frames);
  return map;
}

}  // namespace

std::optional<Eigen::Isometry3d> placeOf(const MapContent& content) {
  const auto blob = content.blobs.find(kPlace);
  if (blob == content.blobs.end()) return std::nullopt;
  const Eigen::Isometry3d T_world_map = decodeTransform(blob->second);
  if (!isRigid(T_world_map)) throw InputError("where the map stands is no rigid motion");
  return T_world_map;
}

std::optional<DepthCalibration> calibrationOf(const MapContent& content) {
  const auto blob = content.blobs.find(kCalibration);
  if (blob == content.blobs.end()) return std::nullopt;
  return parseCalibration(blob->second, "its calibration of depth");
}

Config settingsOf(const MapContent& content, const std::string& file) {
  Config config;
  if (!content.settings.empty()) applyYaml(config, parseYaml(content.settings, file), file);
  return config;
}

SavedMap readSavedMap(const std::string& path) {
  try {
    return savedMap(MapReader(path));
  } catch (const InputError& error) {
    const std::string text = error.what(), name = path + ": ";
    throw InputError(text.rfind(name, 0) == 0 ? text : name + text);
  }
}

std::optional<PinholeCamera> firstCamera(FrameSource& frames) {
  while (const auto next = frames.next()) {
    if (!next->defect.empty() || !defectOf(next->frame).empty()) continue;
    return Rectifier().rectify(next->frame).camera;
  }
  return std::nullopt;
}

std::string cameraDefect(const std::string& file, const PinholeCamera& of_map,
                         const PinholeCamera& of_frames, const std::string& whose) {
  if (isSameCamera(of_map, of_frames)) return {};
  return file + ": is a map of another camera (" + describe(of_map) + ") than " + whose + " (" +
         describe(of_frames) + ")";
}

std::string cameraDefect(const std::string& file, const PinholeCamera& of_map, FrameSource& frames,
                         const std::string& whose) {
  const auto camera = firstCamera(frames);
  return camera ? cameraDefect(file, of_map, *camera, whose) : "";
}

MapRecording::MapRecording(const std::string& path, MapWriter::Mode mode, std::string settings,
                           const Mapper& mapper)
    : writer_(path, mode), settings_(std::move(settings)) {
  if (mode == MapWriter::Mode::create) return;
  written_.frames = mapper.backEnd().loadedFrames();
  written_.keyframes = static_cast<int>(mapper.backEnd().loadedKeyframes());
}

std::string MapRecording::update(const PinholeCamera& camera, const Mapper& mapper) {
  if (work_.valid() && work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return {};
  }
  std::string error = takeResult();
  const auto now = std::chrono::steady_clock::now();
  if (mapper.map().frame() < 0 || now - begun_ < kPeriod) return error;
  camera_ = camera;
  begun_ = now;
  auto changed = std::make_shared<const MapUpdate>(changes(mapper));
  writing_ = amountOf(mapper);
  work_ = std::async(std::launch::async, [this, changed] { writer_.write(*changed); });
  return error;
}

bool MapRecording::finish(const Mapper& mapper) {
  takeResult();
  if (mapper.map().frame() < 0 || camera_.width == 0) return false;
  writer_.write(changes(mapper));
  written_ = amountOf(mapper);
  return true;
}

MapRecording::Written MapRecording::amountOf(const Mapper& mapper) {
  return {mapper.map().frame(), mapper.backEnd().frames().size(),
          static_cast<int>(mapper.backEnd().graph().keyframes().size()), mapper.depthVersion()};
}

/// All that the file does not have yet.
MapUpdate MapRecording::changes(const Mapper& mapper) const {
  const PoseGraph& graph = mapper.backEnd().graph();
  const auto& frames = mapper.backEnd().frames();
  MapUpdate update;
  update.camera = camera_;
  update.settings = settings_;
  update.brightness = mapper.brightness();
  update.frame = mapper.map().frame();
  update.graph_version = graph.version();
  update.keyframes = graph.keyframes();
  update.constraints = graph.keptConstraints();
  update.frames.assign(frames.begin() + static_cast<std::ptrdiff_t>(written_.frames), frames.end());
  for (const KeyframeView& view : mapper.keyframeViews()) {
    const bool is_known = view.id < written_.keyframes;
    if (is_known && written_.depth_version == mapper.depthVersion()) continue;
    update.images.push_back({static_cast<int>(view.id), view.intensity, view.depth_mm});
    update.blobs[keyframeBlob(view.id)] = encodeThumbnail(view);
  }
  if (mapper.calibration()) update.blobs[kCalibration] = calibrationText(*mapper.calibration());
  if (mapper.placed()) update.blobs[kPlace] = encode(*mapper.placed());
  update.block_count = static_cast<std::uint32_t>(mapper.map().blocks().size());
  update.blocks = changedBlocks(mapper.map(), written_.frame);
  return update;
}

/// Of the write in work, waited for: what was wrong with it.
std::string MapRecording::takeResult() {
  if (!work_.valid()) return {};
  try {
    work_.get();
    written_ = writing_;
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace pf

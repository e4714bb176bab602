// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/ferns.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>
#include <utility>

#include "bytes.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

constexpr int kCodes = 16;
constexpr int kMaxFerns = 100'000;
constexpr double kMinDepth_m = 0.4;
constexpr double kLeastGood = 0.1;
constexpr std::uint32_t kFernsMagic = 0x4E524650, kFernsVersion = 1;  // "PFRN"

}  // namespace

Thumbnail thumbnailOf(const WorkingFrame& frame) {
  const cv::Size size(Thumbnail::kWidth, Thumbnail::kHeight);
  Thumbnail small;
  cv::resize(frame.color, small.color, size, 0, 0, cv::INTER_AREA);
  cv::resize(frame.depth_m, small.depth_m, size, 0, 0, cv::INTER_NEAREST);
  cv::Mat still;
  cv::resize(frame.levels[0].still, still, size, 0, 0, cv::INTER_AREA);
  small.depth_m.setTo(0, still < 255);
  return small;
}

FernDatabase::FernDatabase(const FernConfig& config) : config_(config) {
  if (config.count < 1 || config.count > kMaxFerns) {
    throw InputError("ferns: count is " + std::to_string(config.count) + ", expected 1 to " +
                     std::to_string(kMaxFerns));
  }
  if (!(config.max_depth_m > kMinDepth_m) || !(config.novelty >= 0) || config.novelty > 1) {
    throw InputError("ferns: expected max_depth_m above 0.4 and novelty from 0 to 1");
  }
  // The distributions of the standard library differ between its makers; its generator does not.
  std::mt19937 random(config.seed);
  const auto below = [&](std::uint32_t n) { return random() % n; };
  for (int i = 0; i < config.count; ++i) {
    Fern fern;
    fern.pixel = static_cast<int>(below(Thumbnail::kWidth * Thumbnail::kHeight));
    for (auto& threshold : fern.color) threshold = static_cast<std::uint8_t>(below(256));
    const double share = static_cast<double>(random()) / 4294967296.0;
    fern.depth_m = static_cast<float>(kMinDepth_m + share * (config.max_depth_m - kMinDepth_m));
    ferns_.push_back(fern);
  }
  lists_.resize(static_cast<std::size_t>(kCodes) * ferns_.size());
}

FernCode FernDatabase::encode(const Thumbnail& thumbnail) const {
  FernCode code;
  code.bits.reserve(ferns_.size());
  for (const Fern& fern : ferns_) {
    const int v = fern.pixel / Thumbnail::kWidth, u = fern.pixel % Thumbnail::kWidth;
    const float depth = thumbnail.depth_m.at<float>(v, u);
    if (!(depth > 0)) {
      code.bits.push_back(FernCode::kNoFern);
      continue;
    }
    const auto& color = thumbnail.color.at<cv::Vec3b>(v, u);
    int bits = depth > fern.depth_m ? 8 : 0;
    for (int i = 0; i < 3; ++i) bits |= color[i] > fern.color[i] ? 1 << i : 0;
    code.bits.push_back(static_cast<std::uint8_t>(bits));
    ++code.good;
  }
  return code;
}

double FernDatabase::dissimilarity(const FernCode& a, const FernCode& b) {
  const int good = std::min(a.good, b.good);
  if (good == 0 || a.bits.size() != b.bits.size()) return 1.0;
  int same = 0;
  for (std::size_t i = 0; i < a.bits.size(); ++i) {
    same += a.bits[i] == b.bits[i] && a.bits[i] != FernCode::kNoFern ? 1 : 0;
  }
  return 1.0 - static_cast<double>(same) / good;
}

std::vector<FernMatch> FernDatabase::nearest(const FernCode& code, std::size_t most) const {
  if (code.bits.size() != ferns_.size() || code.good == 0) return {};
  std::vector<int> same(ids_.size(), 0);
  for (std::size_t fern = 0; fern < ferns_.size(); ++fern) {
    if (code.bits[fern] == FernCode::kNoFern) continue;
    for (const std::uint32_t k : lists_[kCodes * fern + code.bits[fern]]) ++same[k];
  }
  std::vector<FernMatch> matches;
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    const int good = std::min(code.good, codes_[k].good);
    matches.push_back({ids_[k], 1.0 - static_cast<double>(same[k]) / good});
  }
  std::stable_sort(matches.begin(), matches.end(), [](const FernMatch& a, const FernMatch& b) {
    return a.dissimilarity < b.dissimilarity;
  });
  matches.resize(std::min(most, matches.size()));
  return matches;
}

bool FernDatabase::harvest(std::int64_t id, const FernCode& code) {
  if (code.bits.size() != ferns_.size()) return false;
  if (code.good < kLeastGood * static_cast<double>(ferns_.size())) return false;
  const auto best = nearest(code, 1);
  if (!best.empty() && best[0].dissimilarity <= config_.novelty) return false;
  store(id, code);
  return true;
}

void FernDatabase::forget(const std::function<bool(std::int64_t id)>& is_forgotten) {
  if (std::none_of(ids_.begin(), ids_.end(), is_forgotten)) return;
  const std::vector<std::int64_t> ids = std::exchange(ids_, {});
  const std::vector<FernCode> codes = std::exchange(codes_, {});
  for (auto& list : lists_) list.clear();
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (!is_forgotten(ids[k])) store(ids[k], codes[k]);
  }
}

void FernDatabase::store(std::int64_t id, const FernCode& code) {
  for (std::size_t fern = 0; fern < ferns_.size(); ++fern) {
    if (code.bits[fern] == FernCode::kNoFern) continue;
    lists_[kCodes * fern + code.bits[fern]].push_back(static_cast<std::uint32_t>(ids_.size()));
  }
  ids_.push_back(id);
  codes_.push_back(code);
}

std::string FernDatabase::toBytes() const {
  ByteWriter out;
  out.put(kFernsMagic);
  out.put(kFernsVersion);
  out.put(static_cast<std::int32_t>(config_.count));
  out.put(config_.seed);
  out.put(config_.max_depth_m);
  out.put(config_.novelty);
  out.put(static_cast<std::uint32_t>(ids_.size()));
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    out.put(ids_[k]);
    out.append(codes_[k].bits.data(), codes_[k].bits.size());
  }
  return out.bytes();
}

FernDatabase FernDatabase::fromBytes(const std::string& bytes) {
  ByteReader in(bytes, "ferns");
  in.expect(kFernsMagic, kFernsVersion);
  FernConfig config;
  config.count = in.get<std::int32_t>();
  config.seed = in.get<std::uint32_t>();
  config.max_depth_m = in.get<double>();
  config.novelty = in.get<double>();
  FernDatabase database(config);
  const auto count = in.get<std::uint32_t>();
  const auto ferns = static_cast<std::size_t>(config.count);
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto id = in.get<std::int64_t>();
    FernCode code;
    code.bits.resize(ferns);
    in.read(code.bits.data(), ferns);
    for (const std::uint8_t bits : code.bits) {
      if (bits == FernCode::kNoFern) continue;
      if (bits >= kCodes) in.fail("a code is out of range");
      ++code.good;
    }
    if (code.good == 0) in.fail("a keyframe says nothing");
    database.store(id, code);
  }
  in.finish();
  return database;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/avatar.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

constexpr float kBodyCell_m = 0.0145F;
constexpr float kHeadCell_m = 0.0065F;
constexpr float kHandCell_m = 0.0065F;
constexpr float kBlend_m = 0.022F;

float unionOf(const std::vector<Blob>& blobs, const Vector3f& p, float rounding_m) {
  float d = 1e9F;
  for (const Blob& blob : blobs) d = smoothMin(d, blob.distance(p), rounding_m);
  return d;
}

bool neighbours(int a, int b) {
  return a == b || Rig::kParent[static_cast<std::size_t>(a)] == b ||
         Rig::kParent[static_cast<std::size_t>(b)] == a;
}

Eigen::AlignedBox3f boxOf(const std::vector<Blob>& blobs) {
  Eigen::AlignedBox3f box;
  for (const Blob& blob : blobs) {
    const Vector3f margin = Vector3f::Constant(std::max(blob.radius_a, blob.radius_b) + 0.03F);
    for (const Vector3f& p : {blob.a, blob.b}) {
      box.extend(p - margin);
      box.extend(p + margin);
    }
  }
  return box;
}

}  // namespace

Avatar::Avatar(const Build& build, const Outfit& outfit, float coarseness)
    : rig_(build), appearance_(rig_, outfit) {
  const std::vector<Blob> body = bodyBlobs(rig_, outfit);
  const auto body_distance = [&](const Vector3f& p) {
    // Folds of cloth: hollows and ridges of a few millimetres.
    const float folds = 0.0045F * latticeNoise(Vector3f(p.x() * 17, p.y() * 17, p.z() * 11), 91U) +
                        0.0025F * latticeNoise(34.0F * p, 92U);
    return unionOf(body, p, 0.030F) + folds;
  };
  Eigen::AlignedBox3f body_box = boxOf(body);
  add(polygonise(body_distance, body_box, coarseness * kBodyCell_m), body, body_distance);
  addHead(outfit, coarseness * kHeadCell_m);
  addHands(coarseness * kHandCell_m);
  addBurden();
  hair_tag_.resize(rest_.size(), 1.0F);
}

void Avatar::addHead(const Outfit& outfit, float cell_m) {
  first_head_ = static_cast<std::uint32_t>(triangles_.size());
  const HeadShape shape(rig_, outfit);
  const float s = rig_.scale();
  const std::vector<Blob> head = {
      {Bone::head, s * Vector3f(0, 0, 1.57F), s * Vector3f(0, 0, 1.66F), 0.09F, 0.09F},
      {Bone::neck, s * Vector3f(-0.01F, 0, 1.45F), s * Vector3f(0, 0, 1.53F), 0.05F, 0.05F}};
  const auto head_distance = [&](const Vector3f& p) {
    return std::min(shape.skin(p), shape.hair(p));
  };
  const Eigen::AlignedBox3f head_box(s * Vector3f(-0.16F, -0.13F, 1.43F),
                                     s * Vector3f(0.14F, 0.13F, 1.79F));
  const std::size_t before = rest_.size();
  add(polygonise(head_distance, head_box, cell_m), head, head_distance);
  hair_tag_.assign(rest_.size(), 1.0F);
  for (std::size_t v = before; v < rest_.size(); ++v) {
    hair_tag_[v] = shape.hair(rest_[v]) - shape.skin(rest_[v]);
  }
}

void Avatar::addHands(float cell_m) {
  first_hand_ = static_cast<std::uint32_t>(triangles_.size());
  for (const float side : {1.0F, -1.0F}) {
    const std::vector<Blob> hand = handBlobs(rig_, side);
    const auto hand_distance = [&](const Vector3f& p) { return unionOf(hand, p, 0.006F); };
    add(polygonise(hand_distance, boxOf(hand), cell_m), hand, hand_distance);
  }
}

void Avatar::addBurden() {
  first_burden_ = static_cast<std::uint32_t>(triangles_.size());
  const Vector3f centre = rig_.start[index(Bone::burden)], half(0.13F, 0.155F, 0.11F);
  const auto distance = [&](const Vector3f& p) {
    const Vector3f beyond = (p - centre).cwiseAbs() - half;
    return beyond.cwiseMax(0.0F).norm() + std::min(0.0F, beyond.maxCoeff());
  };
  const Vector3f margin = Vector3f::Constant(0.05F);
  const Eigen::AlignedBox3f box(centre - half - margin, centre + half + margin);
  const std::vector<Blob> blobs = {{Bone::burden, centre, centre, 0.1F, 0.1F}};
  add(polygonise(distance, box, 0.02F), blobs, distance);
}

void Avatar::add(const TriangleMesh& part, const std::vector<Blob>& blobs,
                 const std::function<float(const Vector3f&)>& distance) {
  const auto first = static_cast<std::uint32_t>(rest_.size());
  for (const auto& t : part.triangles) {
    triangles_.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  rest_.insert(rest_.end(), part.positions.begin(), part.positions.end());
  normals_.insert(normals_.end(), part.normals.begin(), part.normals.end());
  openness_.resize(rest_.size());
  influences_.resize(rest_.size());
  parallelFor(part.positions.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // In the open the distance grows as fast as the step away from the surface.
      float open = 0.0F;
      for (const float step : {0.02F, 0.06F}) {
        open += 0.5F *
                std::clamp(distance(part.positions[i] + step * part.normals[i]) / step, 0.0F, 1.0F);
      }
      openness_[first + i] = 0.35F + 0.65F * open;
      Influence& influence = influences_[first + i];
      influence = {};
      bind(part.positions[i], blobs, influence);
    }
  });
}

void Avatar::bind(const Vector3f& p, const std::vector<Blob>& blobs, Influence& influence) {
  std::array<float, kBoneCount> distance;
  distance.fill(1e9F);
  for (const Blob& blob : blobs) {
    float& d = distance[index(blob.bone)];
    d = std::min(d, blob.distance(p));
  }
  const int nearest =
      static_cast<int>(std::min_element(distance.begin(), distance.end()) - distance.begin());
  std::vector<std::pair<float, int>> candidates;
  for (int bone = 0; bone < kBoneCount; ++bone) {
    if (!neighbours(bone, nearest)) continue;
    const float excess =
        distance[static_cast<std::size_t>(bone)] - distance[static_cast<std::size_t>(nearest)];
    const float weight = std::exp(-excess / kBlend_m);
    if (weight > 0.02F) candidates.emplace_back(-weight, bone);
  }
  std::sort(candidates.begin(), candidates.end());
  if (candidates.size() > 4) candidates.resize(4);
  float sum = 0.0F;
  for (const auto& [weight, bone] : candidates) sum -= weight;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    influence.bone[i] = static_cast<std::uint8_t>(candidates[i].second);
    influence.weight[i] = -candidates[i].first / sum;
  }
}

BodyPart Avatar::partOf(std::uint32_t triangle) const {
  return triangle < first_head_     ? BodyPart::body
         : triangle < first_hand_   ? BodyPart::head
         : triangle < first_burden_ ? BodyPart::hand
                                    : BodyPart::burden;
}

SurfacePoint Avatar::surfacePoint(std::uint32_t triangle, float u, float v) const {
  const auto& t = triangles_[triangle];
  const float w = 1.0F - u - v;
  return {partOf(triangle), w * rest_[t[0]] + u * rest_[t[1]] + v * rest_[t[2]],
          w * normals_[t[0]] + u * normals_[t[1]] + v * normals_[t[2]],
          w * hair_tag_[t[0]] + u * hair_tag_[t[1]] + v * hair_tag_[t[2]]};
}

void Avatar::skin(const Posture& posture, float* positions) const {
  parallelFor(rest_.size(), 2048, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vector3f sum = Vector3f::Zero();
      for (std::size_t k = 0; k < 4; ++k) {
        const float weight = influences_[i].weight[k];
        if (weight > 0.0F) sum += weight * (posture[influences_[i].bone[k]] * rest_[i]);
      }
      for (int axis = 0; axis < 3; ++axis)
        positions[3 * i + static_cast<std::size_t>(axis)] = sum[axis];
    }
  });
}

void Avatar::skinNormals(const Posture& posture, std::vector<Vector3f>& normals) const {
  normals.resize(rest_.size());
  parallelFor(rest_.size(), 2048, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vector3f sum = Vector3f::Zero();
      for (std::size_t k = 0; k < 4; ++k) {
        const float weight = influences_[i].weight[k];
        if (weight > 0.0F) sum += weight * (posture[influences_[i].bone[k]].linear() * normals_[i]);
      }
      normals[i] = sum.normalized();
    }
  });
}

}  // namespace pf::simulator

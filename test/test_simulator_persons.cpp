// SPDX-License-Identifier: BSD-3-Clause
// Training pictures of people.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <string>

#include "posefusion/core/parallel.hpp"
#include "simulator/body_shape.hpp"
#include "simulator/loose_posture.hpp"
#include "simulator/person_samples.hpp"

namespace pf::simulator {
namespace {

std::vector<char> bytesOf(std::uint32_t seed, std::uint32_t room) {
  std::vector<char> bytes;
  for (const PersonSample& sample : drawSamples(seed, room)) appendBytes(sample, bytes);
  return bytes;
}

TEST(PersonSamples, SameSeedSameBytesWithAnyNumberOfThreads) {
  std::vector<std::vector<char>> together(2);
  parallelFor(2, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) together[i] = bytesOf(3, static_cast<unsigned>(i));
  });
  EXPECT_EQ(together[0].size(), kSamplesPerRoom * kSampleBytes);
  EXPECT_NE(together[0], together[1]);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  for (std::uint32_t room = 0; room < 2; ++room) EXPECT_EQ(bytesOf(3, room), together[room]);
}

TEST(PersonSamples, ProgramWritesTheRequestedRooms) {
  const std::string command = std::string(POSEFUSION_TOOL_DIR) +
                              "/posefusion_person_data --seed 3 --first-room 1 --rooms 1";
  std::FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::vector<char> bytes(kSamplesPerRoom * kSampleBytes + 1);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), pipe));
  EXPECT_EQ(pclose(pipe), 0);
  EXPECT_EQ(bytes, bytesOf(3, 1));
}

/// Whether the person is within a pixel of the place: lateral noise moves the map's rims.
bool isOn(const cv::Mat& person, const cv::Point2f& place, int id) {
  const cv::Rect all(0, 0, person.cols, person.rows);
  const cv::Rect around(cvRound(place.x) - 1, cvRound(place.y) - 1, 3, 3);
  return cv::countNonZero(person(around & all) == id) > 0;
}

TEST(PersonSamples, SeenJointsLieOnTheirPeople) {
  int pictures = 0, with_people = 0, joints = 0, on = 0, pixels = 0, without_depth = 0;
  int near = 0, cut = 0;
  const auto start = std::chrono::steady_clock::now();
  for (std::uint32_t room = 0; room < 3; ++room) {
    for (const PersonSample& sample : drawSamples(7, room)) {
      ++pictures;
      with_people += cv::countNonZero(sample.person) > 0 ? 1 : 0;
      pixels += static_cast<int>(sample.depth_mm.total());
      without_depth += cv::countNonZero(sample.depth_mm == 0);
      for (std::size_t i = 0; i < sample.people.size(); ++i) {
        const auto& truth = sample.people[i];
        const int id = static_cast<int>(i) + 1;
        near += truth.pixels > 160 * 120 / 4 ? 1 : 0;
        cut += cv::countNonZero(sample.person.col(0) == id) > 0 ||
                       cv::countNonZero(sample.person.col(159) == id) > 0
                   ? 1
                   : 0;
        for (std::size_t j = 0; j < truth.joints.size(); ++j) {
          if (truth.states[j] == JointState::unseen) {
            EXPECT_EQ(truth.joints[j], cv::Point2f(-1.0F, -1.0F));
            continue;
          }
          ++joints;
          on += isOn(sample.person, truth.joints[j], id) ? 1 : 0;
        }
      }
    }
  }
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  std::cout << pictures / spent.count() << " pictures a second on this machine, now\n";
  EXPECT_GT(joints, 1000);
  EXPECT_GE(on, 0.99 * joints);
  EXPECT_GT(with_people, 0.5 * pictures);
  EXPECT_LT(with_people, 0.95 * pictures);
  EXPECT_GT(near, 0.05 * pictures);  // a quarter of the picture and more
  EXPECT_GT(cut, 0.1 * pictures);
  EXPECT_GT(without_depth, 0.03 * pixels);
  EXPECT_LT(without_depth, 0.5 * pixels);
}

float distanceTo(const std::vector<Blob>& blobs, const Eigen::Vector3f& p) {
  float least = 1e9F;
  for (const Blob& blob : blobs) least = std::min(least, blob.distance(p));
  return least;
}

TEST(Garments, WidenTheBodyWhereTheyAreWornAndNowhereElse) {
  const Rig rig{Build()};
  Outfit plain = drawOutfit(3, false), worn = plain;
  worn.garments.hem = 0.8F;
  worn.garments.flare_m = 0.1F;
  worn.garments.thickness_m = 0.03F;
  worn.garments.rucksack = worn.garments.bag = true;
  const auto before = bodyBlobs(rig, plain), after = bodyBlobs(rig, worn);
  Dice dice(5);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f p(random(dice, -0.5, 0.5), random(dice, -0.6, 0.6), random(dice, 0, 1.9));
    EXPECT_LE(distanceTo(after, p), distanceTo(before, p) + 1e-6F);
  }
  const Eigen::Vector3f behind(-0.25F, 0.0F, 1.25F), hip(0.0F, 0.26F, 0.92F),
      shin(0.0F, 0.0F, 0.4F), floor(0.0F, 0.0F, 0.0F);
  for (const auto& p : {behind, hip, shin}) {
    EXPECT_GT(distanceTo(before, p), 0.0F) << p.transpose();
    EXPECT_LT(distanceTo(after, p), 0.0F) << p.transpose();
  }
  EXPECT_GT(distanceTo(after, floor), 0.0F);
}

TEST(Garments, AboutHalfOfAllPeopleWearSome) {
  int some = 0;
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    const Garments g = drawGarments(seed);
    some += g.hem > 0.0F || g.thickness_m > 0.0F || g.rucksack || g.bag ? 1 : 0;
  }
  EXPECT_GT(some, 160);
  EXPECT_LT(some, 280);
}

/// Lengths between joints that a bone connects.
std::vector<float> boneLengths(const Rig& rig, const Posture& posture) {
  std::vector<float> lengths;
  for (std::size_t bone = 0; bone < posture.size(); ++bone) {
    const int parent = Rig::kParent[bone];
    if (parent < 0 || bone == index(Bone::burden)) continue;
    const Eigen::Vector3f from =
        posture[static_cast<std::size_t>(parent)] * rig.start[static_cast<std::size_t>(parent)];
    lengths.push_back((posture[bone] * rig.start[bone] - from).norm());
  }
  return lengths;
}

TEST(LoosePosture, KeepsBonesTogether) {
  const Rig rig{Build()};
  Posture rest;
  rest.fill(Eigen::Isometry3f::Identity());
  const auto lengths = boneLengths(rig, rest);
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    Dice dice(seed);
    Posture posture = rest;
    loosen(rig, posture, true, dice);
    const auto now = boneLengths(rig, posture);
    for (std::size_t i = 0; i < now.size(); ++i) EXPECT_NEAR(now[i], lengths[i], 2e-4) << i;
  }
}

TEST(LoosePosture, ALyingPersonIsLow) {
  const Rig rig{Build()};
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    Dice dice(seed);
    Posture posture;
    posture.fill(Eigen::Isometry3f::Identity());
    layDown(rig, 0.4F, dice, posture);
    for (const Bone bone : {Bone::pelvis, Bone::chest, Bone::head, Bone::left_foot}) {
      const float z = (posture[index(bone)] * rig.start[index(bone)]).z();
      EXPECT_GT(z, 0.47F);
      EXPECT_LT(z, 1.35F);  // on the side, upon an arm that is stretched out
    }
  }
}

}  // namespace
}  // namespace pf::simulator

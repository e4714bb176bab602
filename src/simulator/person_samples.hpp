// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "posefusion/pose/skeleton.hpp"

namespace pf::simulator {

constexpr int kSamplePeople = 6;

/// What is known of a joint in a sample.
enum class JointState : std::uint8_t {
  unseen,  ///< out of the picture, or behind something else
  behind,  ///< in the picture, behind the person's own body
  seen
};

/// One training picture for a person model, and the truth of it. Pixel centres at integers.
struct PersonSample {
  cv::Mat depth_mm;  ///< CV_16UC1 160x120, as the depth camera reports it; 0: none
  cv::Mat person;    ///< CV_8UC1: 0 the room, 1 + index the person seen (with or without depth)
  struct Truth {
    Truth() { joints.fill({-1.0F, -1.0F}); }
    std::array<cv::Point2f, kJointCount> joints;  ///< pixels; (-1, -1) where unseen
    std::array<JointState, kJointCount> states{};
    cv::Point2f centre{-1.0F, -1.0F};  ///< half way from neck to hips, may be outside; pixels
    int pixels = 0;                    ///< in view; 0: nothing of the person is
  };
  std::array<Truth, kSamplePeople> people;
};

constexpr int kSamplesPerRoom = 96;

/// The samples of room number `room`: furniture, up to six people in all activities and positions,
/// cameras from the floor to 1.9 m, upright or falling. Depends on the two numbers alone.
std::vector<PersonSample> drawSamples(std::uint32_t seed, std::uint32_t room);

/// Bytes of a sample in a stream, little endian: depth (u16, row by row), person (u8), then for
/// each of the six 18 joints of x, y, state (f32; states 0 unseen, 1 behind, 2 seen), then for each
/// of the six x, y of the centre and pixels in view (f32).
constexpr std::size_t kSampleBytes = 160 * 120 * 3 + kSamplePeople * (kJointCount + 1) * 12;
void appendBytes(const PersonSample& sample, std::vector<char>& bytes);

}  // namespace pf::simulator

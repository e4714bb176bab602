// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/ferns.hpp"

#include <gtest/gtest.h>

#include <random>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

/// A picture of random blocks: other seeds, other places.
Thumbnail picture(std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat color(6, 8, CV_8UC3), depth(6, 8, CV_32FC1);
  random.fill(color, cv::RNG::UNIFORM, 0, 256);
  random.fill(depth, cv::RNG::UNIFORM, 0.5, 5.0);
  Thumbnail small;
  const cv::Mat ten = cv::Mat::ones(10, 10, CV_32FC1);
  small.color.create(Thumbnail::kHeight, Thumbnail::kWidth, CV_8UC3);
  small.depth_m.create(Thumbnail::kHeight, Thumbnail::kWidth, CV_32FC1);
  for (int v = 0; v < Thumbnail::kHeight; ++v) {
    for (int u = 0; u < Thumbnail::kWidth; ++u) {
      small.color.at<cv::Vec3b>(v, u) = color.at<cv::Vec3b>(v / 10, u / 10);
      small.depth_m.at<float>(v, u) = depth.at<float>(v / 10, u / 10);
    }
  }
  return small;
}

FernConfig seeded(std::uint32_t seed) {
  FernConfig config;
  config.seed = seed;
  return config;
}

TEST(Ferns, SameSeedGivesTheSameFerns) {
  const Thumbnail view = picture(1);
  EXPECT_EQ(FernDatabase(seeded(5)).encode(view).bits, FernDatabase(seeded(5)).encode(view).bits);
  EXPECT_NE(FernDatabase(seeded(5)).encode(view).bits, FernDatabase(seeded(6)).encode(view).bits);
}

TEST(Ferns, AViewIsLikeItselfAndUnlikeAnother) {
  const FernDatabase ferns{FernConfig{}};
  const FernCode a = ferns.encode(picture(1)), b = ferns.encode(picture(2));
  EXPECT_EQ(FernDatabase::dissimilarity(a, a), 0.0);
  EXPECT_GT(FernDatabase::dissimilarity(a, b), 0.5);
  EXPECT_EQ(FernDatabase::dissimilarity(a, b), FernDatabase::dissimilarity(b, a));
}

TEST(Ferns, PixelsWithoutDepthDoNotCount) {
  const FernDatabase ferns{FernConfig{}};
  Thumbnail half = picture(1);
  half.depth_m.colRange(0, Thumbnail::kWidth / 2).setTo(0);
  const FernCode whole = ferns.encode(picture(1)), part = ferns.encode(half);
  EXPECT_LT(part.good, whole.good);
  EXPECT_GT(part.good, 0);
  EXPECT_EQ(FernDatabase::dissimilarity(whole, part), 0.0);
  half.depth_m.setTo(0);
  EXPECT_EQ(FernDatabase::dissimilarity(whole, ferns.encode(half)), 1.0);
}

TEST(Ferns, StoresOnlyWhatIsNew) {
  FernDatabase ferns{FernConfig{}};
  EXPECT_TRUE(ferns.harvest(7, ferns.encode(picture(1))));
  EXPECT_FALSE(ferns.harvest(8, ferns.encode(picture(1))));
  EXPECT_TRUE(ferns.harvest(9, ferns.encode(picture(2))));
  Thumbnail blind = picture(3);
  blind.depth_m.setTo(0);
  EXPECT_FALSE(ferns.harvest(10, ferns.encode(blind)));
  EXPECT_EQ(ferns.size(), 2U);
}

TEST(Ferns, TheNearestIsThatOfComparingAll) {
  FernDatabase ferns{FernConfig{}};
  std::vector<FernCode> codes;
  for (int i = 0; i < 20; ++i) {
    codes.push_back(ferns.encode(picture(static_cast<std::uint64_t>(i) + 1)));
    ASSERT_TRUE(ferns.harvest(i, codes.back()));
  }
  Thumbnail noisy = picture(12);
  cv::Mat noise(noisy.color.size(), CV_8UC3);
  cv::RNG random(99);
  random.fill(noise, cv::RNG::UNIFORM, 0, 20);
  noisy.color += noise;
  const FernCode query = ferns.encode(noisy);
  const auto found = ferns.nearest(query, 3);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].id, 11);
  for (const FernMatch& match : found) {
    EXPECT_EQ(match.dissimilarity,
              FernDatabase::dissimilarity(query, codes[static_cast<std::size_t>(match.id)]));
  }
  EXPECT_LE(found[0].dissimilarity, found[1].dissimilarity);
}

TEST(Ferns, ComeBackFromTheirBytes) {
  FernDatabase ferns(seeded(3));
  for (std::uint64_t i = 1; i < 5; ++i) {
    ferns.harvest(static_cast<std::int64_t>(i), ferns.encode(picture(i)));
  }
  const std::string bytes = ferns.toBytes();
  const FernDatabase back = FernDatabase::fromBytes(bytes);
  EXPECT_EQ(back.toBytes(), bytes);
  EXPECT_EQ(back.nearest(back.encode(picture(2)), 1).at(0).id, 2);
}

TEST(Ferns, BadBytesAreRefused) {
  FernDatabase ferns{FernConfig{}};
  ferns.harvest(1, ferns.encode(picture(1)));
  const std::string bytes = ferns.toBytes();
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_THROW(FernDatabase::fromBytes(bytes.substr(0, size)), InputError) << size;
  }
  EXPECT_THROW(FernDatabase::fromBytes(bytes + "x"), InputError);
  std::string newer = bytes;
  newer[4] = 2;
  EXPECT_THROW(FernDatabase::fromBytes(newer), InputError);
  // Any byte may be wrong: refused or read, never a crash.
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    std::string damaged = bytes;
    damaged[random() % damaged.size()] ^= static_cast<char>(1U << (random() % 8));
    try {
      EXPECT_LE(FernDatabase::fromBytes(damaged).size(), 1U);
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/shared_blocks.hpp"

#include <gtest/gtest.h>

#include <future>
#include <numeric>

namespace pf {
namespace {

SharedBlocks numbered(std::size_t count) {
  SharedBlocks blocks;
  for (std::size_t i = 0; i < count; ++i) {
    SurfelBlock& block = blocks.append();
    block.fragment = static_cast<int>(i);
    block.surfels.resize(100);
    std::fill(block.surfels.x.begin(), block.surfels.x.end(), static_cast<float>(i));
  }
  return blocks;
}

double sumOf(const SharedBlocks& blocks) {
  return std::accumulate(blocks.begin(), blocks.end(), 0.0, [](double sum, const SurfelBlock& b) {
    return std::accumulate(b.surfels.x.begin(), b.surfels.x.end(), sum);
  });
}

TEST(SharedBlocks, ACopyCopiesNoBlock) {
  SharedBlocks blocks = numbered(4);
  const SharedBlocks copy = blocks;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(&blocks[i], &copy[i]);
    EXPECT_TRUE(blocks.isShared(i, copy));
  }
}

TEST(SharedBlocks, AChangedBlockIsACopyOfItsOwn) {
  SharedBlocks blocks = numbered(4);
  const SharedBlocks copy = blocks;
  const SurfelBlock* before = &blocks[2];
  blocks.change(2).surfels.x[5] = 77;
  EXPECT_NE(&blocks[2], before);
  EXPECT_EQ(&copy[2], before);
  EXPECT_EQ(copy[2].surfels.x[5], 2);
  EXPECT_EQ(blocks[2].surfels.x[5], 77);
  EXPECT_FALSE(blocks.isShared(2, copy));
  EXPECT_TRUE(blocks.isShared(1, copy));
  const SurfelBlock* own = &blocks[2];
  EXPECT_EQ(&blocks.change(2), own) << "it is one's own already";
}

TEST(SharedBlocks, ABlockIsOnesOwnAgainOnceTheCopyIsGone) {
  SharedBlocks blocks = numbered(1);
  const SurfelBlock* before = &blocks[0];
  { const SharedBlocks copy = blocks; }
  EXPECT_EQ(&blocks.change(0), before);
}

TEST(SharedBlocks, ACopyKeepsWhatIsReserved) {
  SharedBlocks blocks = numbered(1);
  blocks.change(0).surfels.forEachArray([](auto& array) { array.reserve(1000); });
  const SharedBlocks copy = blocks;
  blocks.change(0).surfels.forEachArray([](auto& array) { EXPECT_EQ(array.capacity(), 1000U); });
}

TEST(SharedBlocks, BlocksAreExchanged) {
  SharedBlocks blocks = numbered(3);
  SharedBlocks other = blocks;
  other.change(1).surfels.x.assign(100, 9.0F);
  blocks.swap(1, other);
  EXPECT_EQ(sumOf(blocks), 100.0 * (0 + 9 + 2));
  EXPECT_EQ(sumOf(other), 100.0 * (0 + 1 + 2));
  other.drop(1);
  EXPECT_EQ(other[1].surfels.size(), 0U);
}

TEST(SharedBlocks, CopiesAreReadWhileTheirSourceChanges) {
  SharedBlocks blocks = numbered(20);
  const double expected = sumOf(blocks);
  std::vector<std::future<double>> readers;
  for (int round = 0; round < 50; ++round) {
    readers.push_back(std::async(std::launch::async, [copy = blocks] { return sumOf(copy); }));
    for (std::size_t i = 0; i < 20; ++i) {
      SurfelBlock& block = blocks.change(i);
      std::fill(block.surfels.x.begin(), block.surfels.x.end(), -1.0F);
      std::fill(block.surfels.x.begin(), block.surfels.x.end(), static_cast<float>(i));
    }
  }
  for (auto& reader : readers) EXPECT_EQ(reader.get(), expected);
}

}  // namespace
}  // namespace pf

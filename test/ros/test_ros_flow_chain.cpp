// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/flow_chain.hpp"

#include <gtest/gtest.h>

#include "posefusion_ros/conversions.hpp"

namespace posefusion_ros {
namespace {

/// A corner that moves one pixel a frame: it stands at column `stamp`.
SparseFlowMsg::ConstPtr flowBetween(std::int64_t from_ns, std::int64_t to_ns) {
  pf::SparseFlow flow;
  flow.from_ns = from_ns;
  flow.to_ns = to_ns;
  flow.before = {{static_cast<float>(from_ns), 5.0F}};
  flow.after = {{static_cast<float>(to_ns), 5.0F}};
  std_msgs::Header header;
  header.stamp = toTime(to_ns);
  return SparseFlowMsg::ConstPtr(toMessage(flow, header));
}

void expectFlow(const pf::SparseFlow& flow, std::int64_t from_ns, std::int64_t to_ns) {
  EXPECT_EQ(flow.from_ns, from_ns);
  EXPECT_EQ(flow.to_ns, to_ns);
  ASSERT_EQ(flow.before.size(), 1U);
  EXPECT_EQ(flow.before[0].x, static_cast<float>(from_ns));
  EXPECT_EQ(flow.after[0].x, static_cast<float>(to_ns));
}

TEST(FlowChain, AFrameThatIsTakenHasItsOwnFlow) {
  FlowChain chain(10);
  chain.add(flowBetween(10, 11));
  expectFlow(chain.take(toTime(11)), 10, 11);
  chain.add(flowBetween(11, 12));
  chain.add(flowBetween(12, 13));
  expectFlow(chain.take(toTime(12)), 11, 12);
  expectFlow(chain.take(toTime(13)), 12, 13);
}

TEST(FlowChain, FramesThatAreDroppedDoNotBreakIt) {
  FlowChain chain(10);
  for (int i = 10; i < 15; ++i) chain.add(flowBetween(i, i + 1));
  expectFlow(chain.take(toTime(11)), 10, 11);
  expectFlow(chain.take(toTime(14)), 11, 14);
  expectFlow(chain.take(toTime(15)), 14, 15);
}

TEST(FlowChain, BeginsAnewAfterAJumpInTime) {
  FlowChain chain(10);
  chain.add(flowBetween(1010, 1011));
  chain.add(flowBetween(0, 501));
  chain.add(flowBetween(501, 502));
  expectFlow(chain.take(toTime(502)), 0, 502);
  EXPECT_TRUE(chain.take(toTime(1011)).empty()) << "it was dropped before the jump";
}

TEST(FlowChain, ForgetsTheOldestBeyondItsCapacity) {
  FlowChain chain(2);
  for (int i = 10; i < 15; ++i) chain.add(flowBetween(i, i + 1));
  EXPECT_TRUE(chain.take(toTime(12)).empty());
  expectFlow(chain.take(toTime(15)), 13, 15);
}

}  // namespace
}  // namespace posefusion_ros

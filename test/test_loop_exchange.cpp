// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/loop_exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "loop_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {
namespace {

/// Answers as the test sets it.
class FakeResponder : public LoopResponder {
 public:
  std::uint64_t ask(LoopQuestion question) override {
    questions.push_back(std::move(question));
    return questions.size();
  }
  bool isReady(std::uint64_t number) override { return is_ready || ready.count(number) > 0; }
  std::optional<LoopAnswer> take(std::uint64_t number) override {
    if (throws) throw std::runtime_error("broken");
    taken.push_back(number);
    return std::nullopt;
  }
  void forget() override { questions.clear(); }
  bool isReplaced() override { return std::exchange(is_replaced, false); }

  std::vector<LoopQuestion> questions;
  std::set<std::uint64_t> ready;     ///< numbers; the first question has 1
  std::vector<std::uint64_t> taken;  ///< numbers, in order
  bool is_ready = false, throws = false, is_replaced = false;
};

class LoopExchanges : public testing::Test {
 protected:
  explicit LoopExchanges(AnswerTime time = AnswerTime::when_ready) {
    config.frame.shrink = 1;
    config.graph.keyframe_distance_m = 0.05;
    config.tracking.sure_to_return = 0.999;  // not before the loop closer is asked again
    auto owned = std::make_unique<FakeResponder>();
    closer = owned.get();
    mapper = std::make_unique<Mapper>(config);
    exchange = std::make_unique<LoopExchange>(config.loop.answer_lag_s, time, std::move(owned));
  }
  void see(int index, bool covered = false) {
    StaticFrame input;
    input.frame = room().frame(index).frame;
    input.frame.stamp_ns = stamp_ns += 33333333;
    if (covered) input.frame.depth.setTo(0);
    mapper->process(input);
    exchange->serve(*mapper);
  }

  Config config;
  FakeResponder* closer = nullptr;
  std::unique_ptr<Mapper> mapper;
  std::unique_ptr<LoopExchange> exchange;
  std::int64_t stamp_ns = 0;
};

TEST_F(LoopExchanges, ALostCamerasQuestionHoldsTheCorrectionsSinceTheLast) {
  for (int i = 0; i < kMapped; ++i) see(i);
  const auto& keyframes = mapper->backEnd().graph().keyframes();
  ASSERT_GT(keyframes.size(), 1U);
  const Keyframe first = keyframes.front(), last = keyframes.back();
  LoopAnswer answer;
  LoopConstraint loop{first.id, last.id, first.T_map_camera.inverse() * last.T_map_camera,
                      1e-6 * Matrix6d::Identity()};
  loop.T_from_to.translation().x() += 0.03;  // enough to be worth a correction
  answer.loops.push_back(loop);
  mapper->take(answer);
  mapper->settle();
  ASSERT_EQ(mapper->backEnd().counts().accepted, 1U);
  closer->questions.clear();
  for (int i = 0; i < kCovered; ++i) see(kMapped - 1, true);
  for (int i = 0; i < 3 && closer->questions.empty(); ++i) see(farthestFrame());
  ASSERT_EQ(closer->questions.size(), 2U)
      << "the update first, then the place in a question of its own";
  EXPECT_EQ(closer->questions[0].place, nullptr);
  EXPECT_FALSE(closer->questions[0].is_urgent);
  ASSERT_NE(closer->questions[1].place, nullptr);
  EXPECT_TRUE(closer->questions[1].is_urgent);
  EXPECT_FALSE(closer->questions[1].tellsMore());
  ASSERT_EQ(closer->questions[0].corrected.size(), mapper->backEnd().keyframePoses().size());
  EXPECT_EQ(closer->questions[0].corrected.back().T_map_camera.matrix(),
            mapper->backEnd().keyframePoses().back().T_map_camera.matrix());
}

TEST_F(LoopExchanges, ALostCameraAsksAgainWhenAQuestionWasGivenUp) {
  for (int i = 0; i < 3; ++i) see(i);
  for (int i = 0; i < kCovered; ++i) see(3, true);
  const auto places = [&] {
    return std::count_if(closer->questions.begin(), closer->questions.end(),
                         [](const LoopQuestion& question) { return question.place != nullptr; });
  };
  for (int i = 0; i < 3; ++i) see(farthestFrame());
  ASSERT_EQ(places(), 1) << "no second question before the answer to the first";
  closer->is_ready = true;  // given up
  see(farthestFrame());
  closer->is_ready = false;
  EXPECT_EQ(exchange->unanswered(), closer->questions.size());
  see(farthestFrame());
  EXPECT_EQ(places(), 2);
  closer->throws = closer->is_ready = true;
  EXPECT_THROW(see(farthestFrame()), std::runtime_error);
  closer->throws = closer->is_ready = false;
  see(farthestFrame());
  EXPECT_EQ(places(), 3) << "it goes on after the exception";
}

TEST_F(LoopExchanges, ALostCamerasAnswerIsTakenBeforeThoseThatWait) {
  int next = 0;
  for (; next < kMapped && closer->questions.size() < 3; ++next) see(next);
  ASSERT_EQ(closer->questions.size(), 3U) << "the test needs keyframes";
  for (int i = 0; i < kCovered; ++i) see(next, true);
  for (int i = 0; i < 3; ++i) see(farthestFrame());
  const std::uint64_t place = closer->questions.size();
  ASSERT_TRUE(closer->questions.back().is_urgent);
  closer->ready = {place};
  see(farthestFrame());
  EXPECT_EQ(closer->taken, (std::vector<std::uint64_t>{place}));
  closer->ready = {2, 3};
  see(farthestFrame());
  EXPECT_EQ(closer->taken.size(), 1U) << "all others in their order";
  closer->ready = {1, 2, 3};
  see(farthestFrame());
  EXPECT_EQ(closer->taken, (std::vector<std::uint64_t>{place, 1, 2, 3}));
}

TEST_F(LoopExchanges, WhereTheCloserIsBehindNeighboursAreAddedButNotCompared) {
  int next = 0;
  for (; next < kMapped && closer->questions.size() < 8; ++next) see(next);
  ASSERT_EQ(closer->questions.size(), 8U) << "the test needs keyframes";
  EXPECT_EQ(exchange->waiting(), 8U);
  EXPECT_GT(exchange->oldestWaitsS(), 0.0);
  const auto seeks = [&](std::size_t i) { return closer->questions[i].seeks_loops; };
  for (std::size_t i = 0; i < 6; ++i) EXPECT_TRUE(seeks(i)) << i;
  EXPECT_FALSE(seeks(6));
  EXPECT_FALSE(seeks(7));
  closer->ready = {1, 2};
  for (; next < kMapped && closer->questions.size() < 9; ++next) see(next);
  ASSERT_EQ(closer->questions.size(), 9U) << "the test needs keyframes";
  EXPECT_TRUE(seeks(8)) << "two were answered";
}

TEST_F(LoopExchanges, AVoidQuestionForAPlaceIsNotSearched) {
  for (int i = 0; i < 10; ++i) see(i);
  for (int i = 0; i < kCovered; ++i) see(10, true);
  for (int i = 0; i < 20 && !closer->questions.back().place; ++i) see(9);
  const LoopQuestion question = closer->questions.back();
  ASSERT_NE(question.place, nullptr);
  EXPECT_FALSE(*question.place_is_void);
  LoopWorker worker(config.loop, config.tracking, depthSensorOf(config));
  for (int i = 0; i < 40 && mapper->isLookedFor(); ++i) see(9);
  ASSERT_FALSE(mapper->isLookedFor()) << "back by itself";
  see(9);
  EXPECT_TRUE(*question.place_is_void);
  const LoopAnswer answer = worker.answer(question);
  EXPECT_TRUE(answer.asked_for_place);
  EXPECT_FALSE(answer.place);
  EXPECT_EQ(answer.counts.searched, 0U);
}

/// Offline, where answers depend on the order of the questions, nothing is urgent.
class LaggingExchange : public LoopExchanges {
 protected:
  LaggingExchange() : LoopExchanges(AnswerTime::after_lag) {}
};

TEST_F(LaggingExchange, AsksInOneAndInOrder) {
  for (int i = 0; i < 10; ++i) see(i);
  for (int i = 0; i < kCovered; ++i) see(10, true);
  for (int i = 0; i < 3; ++i) see(farthestFrame());
  ASSERT_FALSE(closer->questions.empty());
  EXPECT_NE(closer->questions.back().place, nullptr);
  for (const LoopQuestion& question : closer->questions) EXPECT_FALSE(question.is_urgent);
}

TEST_F(LoopExchanges, ANewCloserGetsAllKeyframes) {
  int next = 0;
  for (; next < kMapped && closer->questions.size() < 3; ++next) see(next);
  ASSERT_EQ(closer->questions.size(), 3U) << "the test needs keyframes";
  for (const LoopQuestion& question : closer->questions) EXPECT_FALSE(question.known);
  closer->is_replaced = true;
  for (; next < kMapped && closer->questions.size() < 4; ++next) see(next);
  ASSERT_EQ(closer->questions.size(), 4U);
  ASSERT_TRUE(closer->questions.back().known);
  EXPECT_EQ(closer->questions.back().known->size(), 3U);
  EXPECT_EQ(closer->questions.back().corrected.size(), 3U);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// A lost camera does not wait for the earlier questions to the loop closer.
#include <gtest/gtest.h>

#include <algorithm>

#include "chain_fixture.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/loop_messages.hpp"

namespace posefusion_ros {
namespace {

constexpr int kWaiting = 50, kFramesThere = 40;

pf::Config closeKeyframes() {
  pf::Config config;
  config.frame.shrink = 1;
  config.graph.keyframe_distance_m = 0.02;
  config.graph.keyframe_angle_rad = 0.03;
  return config;
}

/// The questions of a mapper that maps the room to and fro without answers, and is then lost in it.
std::vector<pf::LoopQuestion> questionsOfALostMapper() {
  pf::Mapper mapper(closeKeyframes());
  std::vector<pf::LoopQuestion> asked;
  std::int64_t stamp_ns = 0;
  const auto see = [&](int index, bool covered) {
    const int turn = index % (2 * kFramesThere);
    pf::StaticFrame input;
    input.frame = emptyRoom().frame(turn < kFramesThere ? turn : 2 * kFramesThere - 1 - turn).frame;
    input.frame.stamp_ns = stamp_ns += 33'333'333;
    if (covered) input.frame.depth = cv::Mat::zeros(input.frame.depth.size(), CV_16UC1);
    mapper.process(input);
    if (auto question = mapper.takeQuestion()) asked.push_back(std::move(*question));
  };
  int next = 0;
  for (; next < 2000 && asked.size() < kWaiting; ++next) see(next, false);
  for (int i = 0; i < 30; ++i) see(next, true);
  for (int i = 0; i < 10 && !asked.back().place; ++i) see(next + kFramesThere / 2, false);
  return asked;
}

TEST(ChainUrgent, ALostCameraIsAnsweredBeforeFiftyQuestionsThatWait) {
  std::vector<pf::LoopQuestion> questions = questionsOfALostMapper();
  ASSERT_GE(questions.size(), kWaiting) << "the test needs keyframes";
  ASSERT_NE(questions.back().place, nullptr) << "the test needs a lost camera";
  questions.back().is_urgent = true;

  Chain chain("urgent");
  chain.set("frame/shrink", 1);
  std::mutex mutex;
  std::vector<std::uint64_t> answered;
  std::map<std::uint64_t, std::chrono::steady_clock::time_point> when;
  const boost::function<void(const LoopAnswerMessage::ConstPtr&)> note = [&](const auto& answer) {
    const std::lock_guard<std::mutex> lock(mutex);
    answered.push_back(answer->number);
    when[answer->number] = std::chrono::steady_clock::now();
    EXPECT_EQ(answer->error, "");
  };
  auto answers = chain.handle().subscribe<LoopAnswerMessage>(topics::kLoopConstraint, 100, note);
  auto ask = chain.handle().advertise<LoopQuestionMessage>(topics::kKeyframe, 100);
  ASSERT_TRUE(chain.load({"loop_closer"}));
  ASSERT_TRUE(Chain::waitUntil(
      [&] { return ask.getNumSubscribers() > 0 && answers.getNumPublishers() > 0; }));
  const std::uint64_t place = questions.size();
  for (std::uint64_t number = 1; number <= place; ++number) {
    const auto message = boost::make_shared<LoopQuestionMessage>();
    message->number = number;
    message->question = std::move(questions[number - 1]);
    ask.publish(LoopQuestionMessage::ConstPtr(message));
  }
  const auto sent = std::chrono::steady_clock::now();
  constexpr double kAll_s = 300.0;  // all of them take 20 s, where the sanitizers watch minutes
  ASSERT_TRUE(Chain::waitUntil(
      [&] {
        const std::lock_guard<std::mutex> lock(mutex);
        return answered.size() == place;
      },
      kAll_s));
  const auto at = std::find(answered.begin(), answered.end(), place) - answered.begin();
  EXPECT_LT(at, kWaiting / 2) << "of " << place;
  answered.erase(answered.begin() + at);
  EXPECT_TRUE(std::is_sorted(answered.begin(), answered.end())) << "all others in their order";
  const std::chrono::duration<double> took = when[place] - sent, all = when[place - 1] - sent;
  RecordProperty("place_s", std::to_string(took.count()));
  RecordProperty("all_s", std::to_string(all.count()));
  answers.shutdown();
  chain.unload();
}

}  // namespace
}  // namespace posefusion_ros

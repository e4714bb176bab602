// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "chain_fixture.hpp"
#include "posefusion_ros/loop_messages.hpp"

namespace posefusion_ros {

/// Takes the place of the loop closer and answers on request: with nothing, or with a given result.
class FakeCloser {
 public:
  explicit FakeCloser(Chain& chain) {
    const boost::function<void(const LoopQuestionMessage::ConstPtr&)> take =
        [this](const LoopQuestionMessage::ConstPtr& asked) { onQuestion(*asked); };
    questions_ = chain.handle().subscribe<LoopQuestionMessage>(topics::kKeyframe, 100, take);
    answers_ = chain.handle().advertise<LoopAnswerMessage>(topics::kLoopConstraint, 100);
  }
  ~FakeCloser() { questions_.shutdown(); }

  int asked() const { return asked_; }
  int known() const { return known_; }  ///< keyframes that came with a question
  void answers(bool answers) { does_answer_ = answers; }
  /// Before the chain is loaded.
  void finds(std::function<pf::LoopAnswer(const pf::LoopQuestion&)> find) {
    find_ = std::move(find);
    does_answer_ = true;
  }

 private:
  void onQuestion(const LoopQuestionMessage& asked) {
    ++asked_;
    if (asked.question.known) known_ = static_cast<int>(asked.question.known->size());
    if (!does_answer_) return;
    const auto message = boost::make_shared<LoopAnswerMessage>();
    message->session = asked.session;
    message->number = asked.number;
    message->closer = identity_;
    if (find_) message->answer = find_(asked.question);
    answers_.publish(LoopAnswerMessage::ConstPtr(message));
  }

  const std::uint64_t identity_ = newIdentity();
  std::function<pf::LoopAnswer(const pf::LoopQuestion&)> find_;
  std::atomic<bool> does_answer_{false};
  std::atomic<int> asked_{0}, known_{0};
  ros::Subscriber questions_;
  ros::Publisher answers_;
};

}  // namespace posefusion_ros

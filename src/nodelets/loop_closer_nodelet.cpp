// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <boost/make_shared.hpp>
#include <memory>

#include "posefusion/loop/worker.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/loop_messages.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/worker.hpp"

namespace posefusion_ros {

/// Answers fusion's questions in their order, urgent ones first, in a thread of its own: see
/// pf::LoopWorker.
class LoopCloserNodelet : public ChainNodelet {
 public:
  ~LoopCloserNodelet() override {
    stopWaiting();
    questions_.shutdown();
    if (worker_) worker_->stop();
  }

 private:
  using Question = LoopQuestionMessage::ConstPtr;

  void start() override {
    Parameters parameters(getPrivateNodeHandle());
    const pf::Config config =
        parameters.config({"loop", "tracking", "sensor", "frame", "calibration"});
    report(parameters);
    watch().allowSilence();  // questions are asked now and then
    closer_ = std::make_unique<pf::LoopWorker>(config.loop, config.tracking,
                                               pf::depthSensorOf(config), config.calibration);
    worker_ =
        std::make_unique<Worker<Question>>(0, [this](const Question& asked) { answer(asked); });
    questions_ = getNodeHandle().subscribe(topics::kKeyframe, kInternalQueue,
                                           &LoopCloserNodelet::onQuestion, this);
    whenReady([this] { return questions_.getNumPublishers() > 0; }, [this] { advertise(); });
  }

  /// Fusion takes it for there once it has this topic.
  void advertise() {
    const std::lock_guard<std::mutex> lock(publisher_mutex_);
    publisher_ =
        getNodeHandle().advertise<LoopAnswerMessage>(topics::kLoopConstraint, kInternalQueue);
  }

  void onQuestion(const Question& asked) {
    if (asked->question.is_urgent) {
      worker_->pushFirst(asked);
    } else {
      worker_->push(asked);
    }
  }

  void answer(const Question& asked) {
    const auto message = boost::make_shared<LoopAnswerMessage>();
    message->header = asked->header;
    message->session = asked->session;
    message->number = asked->number;
    message->closer = identity_;
    message->wanted = wantedBy(asked->question);
    const auto& keyframe = asked->question.keyframe;
    message->keyframe = keyframe ? static_cast<std::uint32_t>(keyframe->id) : 0;
    message->answer.asked_for_place = asked->question.place != nullptr;
    try {
      message->answer = closer_->answer(asked->question);
    } catch (const std::exception& error) {
      message->error = error.what();
    }
    watch().set("questions waiting", std::to_string(worker_->waiting()));
    passed(asked->header.stamp);
    const std::lock_guard<std::mutex> lock(publisher_mutex_);
    if (publisher_) publisher_.publish(LoopAnswerMessage::ConstPtr(message));
  }

  const std::uint64_t identity_ = newIdentity();
  std::unique_ptr<pf::LoopWorker> closer_;
  std::mutex publisher_mutex_;  // guards publisher_, which is advertised late
  ros::Publisher publisher_;
  std::unique_ptr<Worker<Question>> worker_;
  ros::Subscriber questions_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::LoopCloserNodelet, nodelet::Nodelet)

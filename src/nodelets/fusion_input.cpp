// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_input.hpp"

#include <utility>

#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {

FusionInput::FusionInput(ros::NodeHandle& handle, Matcher::Handler handler)
    : matcher_(kInternalQueue, std::move(handler)) {
  info_ = subscribe<0>(handle, topics::kSharpCameraInfo);
  color_ = subscribe<1>(handle, topics::kSharpColor);
  depth_ = subscribe<2>(handle, topics::kStaticDepth);
  mask_ = subscribe<3>(handle, topics::kMask);
  flow_ = subscribe<4>(handle, topics::kFlow);
  blur_score_ =
      handle.subscribe(topics::kBlurScore, kInternalQueue, &FusionInput::onBlurScore, this);
  input_depth_ = subscribe<6>(handle, topics::kSharpDepth);
}

template <std::size_t Index>
ros::Subscriber FusionInput::subscribe(ros::NodeHandle& handle, const char* topic) {
  using Pointer = std::tuple_element_t<Index, Set>;
  using Message = std::remove_const_t<typename Pointer::element_type>;
  const boost::function<void(const Pointer&)> take = [this](const Pointer& message) {
    matcher_.add<Index>(message);
  };
  return handle.subscribe<Message>(topic, kInternalQueue, take);
}

void FusionInput::onBlurScore(const BlurScoreMsg::ConstPtr& score) {
  if (score->sharp) matcher_.add<5>(score);
}

pf::StaticFrame toStaticFrame(const FusionInput::Set& set) {
  const auto& [info, color, depth, mask, flow, blur, input_depth] = set;
  pf::StaticFrame input;
  input.frame = toFrame(color, depth, toCamera(*info, false));
  const cv::Mat people = cv_bridge::toCvShare(mask)->image;
  if (cv::countNonZero(people) > 0) input.mask = people;
  input.input_depth = toDepth(input_depth);
  input.flow = fromMessage(*flow);
  input.forced = blur->forced != 0;
  return input;
}

}  // namespace posefusion_ros

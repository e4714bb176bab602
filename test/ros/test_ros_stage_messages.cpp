// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/bags/stage_messages.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <map>

#include "../temporary_folder.hpp"
#include "message_parts.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/model_view.hpp"

namespace posefusion_ros {
namespace {

using pf::errorOf;

TEST(StageMessages, PeopleGoThereAndBack) {
  pf::People people;
  people.stamp_ns = 1234567890123456789;
  people.detected = true;
  people.people.resize(2);
  people.people[1].score = 0.75F;
  people.people[1].joints[17] = {3.25F, 4.5F, 0.5F};
  const auto back = fromMessage(toMessage(people, headerAt(people.stamp_ns)));
  EXPECT_EQ(back.stamp_ns, people.stamp_ns);
  EXPECT_TRUE(back.detected);
  ASSERT_EQ(back.people.size(), 2U);
  EXPECT_EQ(back.people[1].score, 0.75F);
  EXPECT_EQ(back.people[1].joints[17].v, 4.5F);
  EXPECT_EQ(back.people[0].joints[0].p, 0.0F);
}

TEST(StageMessages, TheMaskOfPeopleIsTheMessagesOwn) {
  pf::People people;
  people.mask = {cv::Mat(60, 80, CV_8UC1, cv::Scalar(7)), cv::Mat(60, 80, CV_8UC1, cv::Scalar(1))};
  people.mask.probability.at<std::uint8_t>(59, 3) = 255;
  PeopleMsg message = toMessage(people, headerAt(1));
  const auto back = fromMessage(message);
  EXPECT_TRUE(samePixels(back.mask.probability, people.mask.probability));
  EXPECT_TRUE(samePixels(back.mask.owner, people.mask.owner));
  EXPECT_EQ(back.mask.probability.data, message.mask.data()) << "no copy";
  EXPECT_TRUE(fromMessage(toMessage(pf::People(), headerAt(1))).mask.empty());
  message.mask.pop_back();
  EXPECT_NE(errorOf([&] { fromMessage(message); }).find("4799 cells, expected 80x60"),
            std::string::npos);
  message.mask.clear();
  EXPECT_NE(errorOf([&] { fromMessage(message); }).find("both or none"), std::string::npos);
}

TEST(StageMessages, FlowGoesThereAndBack) {
  pf::SparseFlow flow;
  flow.from_ns = 1234567890123456789;
  flow.to_ns = flow.from_ns + 33333333;
  flow.before = {{0.25F, 1e-3F}, {639.5F, 479.125F}};
  flow.after = {{0.5F, 2.0F}, {630.0F, 470.0F}};
  flow.ids = {3, 4000000000};
  const auto message = toMessage(flow, headerAt(flow.to_ns));
  const pf::SparseFlow back = fromMessage(*message);
  EXPECT_EQ(back.from_ns, flow.from_ns);
  EXPECT_EQ(back.to_ns, flow.to_ns);
  EXPECT_EQ(back.before, flow.before);
  EXPECT_EQ(back.after, flow.after);
  EXPECT_EQ(back.ids, flow.ids);
  const auto unnumbered = boost::make_shared<SparseFlowMsg>(*message);
  unnumbered->ids.pop_back();
  EXPECT_NE(errorOf([&] { fromMessage(*unnumbered); }).find("1 ids for 2 corners"),
            std::string::npos);
  const auto broken = boost::make_shared<SparseFlowMsg>(*message);
  broken->after.pop_back();
  EXPECT_NE(errorOf([&] { fromMessage(*broken); }).find("4 numbers before and 3 after"),
            std::string::npos);
}

TEST(StageMessages, StatusConstantsAreThoseOfTheCore) {
  using pf::FrameOutcome;
  using Status = TrackingStatusMsg;
  const std::map<FrameOutcome, int> outcomes = {
      {FrameOutcome::fused, Status::FUSED},
      {FrameOutcome::located, Status::LOCATED},
      {FrameOutcome::bad_input, Status::BAD_INPUT},
      {FrameOutcome::blurred, Status::BLURRED},
      {FrameOutcome::no_depth, Status::NO_DEPTH},
      {FrameOutcome::not_converged, Status::NOT_CONVERGED},
      {FrameOutcome::few_inliers, Status::FEW_INLIERS},
      {FrameOutcome::degenerate, Status::DEGENERATE},
      {FrameOutcome::jumped, Status::JUMPED},
      {FrameOutcome::disagrees, Status::DISAGREES},
      {FrameOutcome::seen_through, Status::SEEN_THROUGH},
      {FrameOutcome::unproven, Status::UNPROVEN},
      {FrameOutcome::forced, Status::FORCED}};
  for (const auto& [outcome, code] : outcomes) {
    pf::FrameStatus status;
    status.outcome = outcome;
    EXPECT_EQ(toMessage(status, headerAt(0), status.T_map_camera).outcome, code) << name(outcome);
  }
  EXPECT_EQ(name(static_cast<FrameOutcome>(outcomes.size())), "unknown") << "all are listed";

  using pf::TrackingState;
  const std::map<TrackingState, int> states = {{TrackingState::initializing, Status::INITIALIZING},
                                               {TrackingState::tracking, Status::TRACKING},
                                               {TrackingState::doubtful, Status::DOUBTFUL},
                                               {TrackingState::lost, Status::LOST}};
  for (const auto& [state, code] : states) {
    pf::FrameStatus status;
    status.state = state;
    status.located = state == TrackingState::doubtful;
    const Status message = toMessage(status, headerAt(0), status.T_map_camera);
    EXPECT_EQ(message.state, code) << name(state);
    EXPECT_EQ(message.located != 0, status.located);
  }
  EXPECT_EQ(name(static_cast<TrackingState>(states.size())), "unknown") << "all are listed";
}

TEST(StageMessages, TheModelViewKeepsEveryPlaneTheSegmenterReads) {
  pf::ModelView view;
  view.camera.width = 4;
  view.camera.height = 3;
  view.camera.fx = view.camera.fy = 5;
  view.camera.cx = 1.5;
  view.camera.cy = 1.25;
  view.fragment = 2;
  view.T_map_camera.translation() << 0.1, 0.2, 0.3;
  view.T_map_uncorrected.translation() << 0.4, 0.5, 0.6;
  view.depth_m = cv::Mat(3, 4, CV_32FC1, cv::Scalar(1.5));
  view.depth_m.at<float>(2, 3) = 10;
  view.stable = cv::Mat(3, 4, CV_8UC1, cv::Scalar(255));
  view.stable.at<std::uint8_t>(1, 2) = 0;
  const ModelViewMsg::ConstPtr message = toMessage(view, std_msgs::Header());  // owns the pixels
  const pf::ModelView read = fromMessage(message);
  EXPECT_TRUE(read.camera == view.camera);
  EXPECT_EQ(read.fragment, 2);
  EXPECT_TRUE(read.T_map_camera.matrix() == view.T_map_camera.matrix());
  EXPECT_TRUE(read.T_map_uncorrected.matrix() == view.T_map_uncorrected.matrix());
  EXPECT_FALSE(read.T_world_map) << "not known yet";
  view.T_world_map = Eigen::Translation3d(1, 2, 3) * Eigen::Isometry3d::Identity();
  const pf::ModelView placed = fromMessage(toMessage(view, std_msgs::Header()));
  ASSERT_TRUE(placed.T_world_map);
  EXPECT_TRUE(placed.T_world_map->matrix() == view.T_world_map->matrix());
  for (const auto plane : {&pf::ModelView::depth_m, &pf::ModelView::stable}) {
    EXPECT_TRUE(samePixels(read.*plane, view.*plane));
  }
}

}  // namespace
}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/stage_messages.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>

#include "../temporary_folder.hpp"
#include "posefusion_ros/conversions.hpp"
#include "posefusion_ros/model_view.hpp"

namespace posefusion_ros {
namespace {

using pf::errorOf;

std_msgs::Header headerAt(std::int64_t stamp_ns) {
  std_msgs::Header header;
  header.stamp = toTime(stamp_ns);
  header.frame_id = "optical";
  return header;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

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

TEST(StageMessages, FlowGoesThereAndBack) {
  pf::SparseFlow flow;
  flow.from_ns = 1234567890123456789;
  flow.to_ns = flow.from_ns + 33333333;
  flow.before = {{0.25F, 1e-3F}, {639.5F, 479.125F}};
  flow.after = {{0.5F, 2.0F}, {630.0F, 470.0F}};
  const auto message = toMessage(flow, headerAt(flow.to_ns));
  const pf::SparseFlow back = fromMessage(*message);
  EXPECT_EQ(back.from_ns, flow.from_ns);
  EXPECT_EQ(back.to_ns, flow.to_ns);
  EXPECT_EQ(back.before, flow.before);
  EXPECT_EQ(back.after, flow.after);
  const auto broken = boost::make_shared<SparseFlowMsg>(*message);
  broken->after.pop_back();
  EXPECT_NE(errorOf([&] { fromMessage(*broken); }).find("4 numbers before and 3 after"),
            std::string::npos);
}

TEST(StageMessages, StatusConstantsAreThoseOfTheCore) {
  using pf::FrameOutcome;
  const auto code = [](FrameOutcome outcome) {
    pf::FrameStatus status;
    status.outcome = outcome;
    return toMessage(status, headerAt(0), status.T_map_camera).outcome;
  };
  EXPECT_EQ(code(FrameOutcome::fused), std::uint8_t{TrackingStatusMsg::FUSED});
  EXPECT_EQ(code(FrameOutcome::bad_input), std::uint8_t{TrackingStatusMsg::BAD_INPUT});
  EXPECT_EQ(code(FrameOutcome::blurred), std::uint8_t{TrackingStatusMsg::BLURRED});
  EXPECT_EQ(code(FrameOutcome::no_depth), std::uint8_t{TrackingStatusMsg::NO_DEPTH});
  EXPECT_EQ(code(FrameOutcome::not_converged), std::uint8_t{TrackingStatusMsg::NOT_CONVERGED});
  EXPECT_EQ(code(FrameOutcome::few_inliers), std::uint8_t{TrackingStatusMsg::FEW_INLIERS});
  EXPECT_EQ(code(FrameOutcome::jumped), std::uint8_t{TrackingStatusMsg::JUMPED});

  using pf::TrackingState;
  const auto state = [](TrackingState value) {
    pf::FrameStatus status;
    status.state = value;
    return toMessage(status, headerAt(0), status.T_map_camera).state;
  };
  EXPECT_EQ(state(TrackingState::initializing), std::uint8_t{TrackingStatusMsg::INITIALIZING});
  EXPECT_EQ(state(TrackingState::tracking), std::uint8_t{TrackingStatusMsg::TRACKING});
  EXPECT_EQ(state(TrackingState::lost), std::uint8_t{TrackingStatusMsg::LOST});
}

TEST(StageMessages, TheModelViewKeepsEveryPlaneTheSegmenterReads) {
  pf::ModelView view;
  view.camera.width = 4;
  view.camera.height = 3;
  view.camera.fx = view.camera.fy = 5;
  view.camera.cx = 1.5;
  view.camera.cy = 1.25;
  view.T_map_camera.translation() << 0.1, 0.2, 0.3;
  view.depth_m = cv::Mat(3, 4, CV_32FC1, cv::Scalar(1.5));
  view.depth_m.at<float>(2, 3) = 10;
  view.stable = cv::Mat(3, 4, CV_8UC1, cv::Scalar(255));
  view.stable.at<std::uint8_t>(1, 2) = 0;
  const ModelViewMsg::ConstPtr message = toMessage(view, std_msgs::Header());  // owns the pixels
  const pf::ModelView read = fromMessage(message);
  EXPECT_TRUE(read.camera == view.camera);
  EXPECT_TRUE(read.T_map_camera.matrix() == view.T_map_camera.matrix());
  for (const auto plane : {&pf::ModelView::depth_m, &pf::ModelView::stable}) {
    EXPECT_TRUE(same(read.*plane, view.*plane));
  }
}

}  // namespace
}  // namespace posefusion_ros

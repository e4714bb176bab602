// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/own_view.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "place_scene.hpp"
#include "posefusion/loop/verify.hpp"

namespace pf {
namespace {

/// A wall 0.6 m before the camera, in grey levels that look like noise of so much contrast, in
/// squares of 8 pixels.
WorkingFrame wall(double contrast) {
  RgbdFrame frame = room().sequence.frame(0).frame;
  frame.depth = cv::Mat(frame.depth.size(), CV_16UC1, cv::Scalar(600));
  cv::Mat squares(frame.color.rows / 8, frame.color.cols / 8, CV_8UC1);
  cv::Mat noise(frame.color.size(), CV_16SC3);
  cv::RNG random(7);
  random.fill(squares, cv::RNG::NORMAL, 128, contrast);
  random.fill(noise, cv::RNG::NORMAL, 0, 1.5);
  cv::resize(squares, squares, frame.color.size(), 0, 0, cv::INTER_NEAREST);
  cv::cvtColor(squares, frame.color, cv::COLOR_GRAY2RGB);
  cv::add(frame.color, noise, frame.color, cv::noArray(), CV_8U);
  WorkingFrame working;
  working.assign(frame, cv::Mat(), FrameConfig{});
  return working;
}

TEST(OwnView, ARoomCanBePlacedABareWallCannot) {
  EXPECT_TRUE(canBePlaced(room().frame(11), TrackingConfig{}));
  EXPECT_FALSE(canBePlaced(wall(0), TrackingConfig{}));
  EXPECT_TRUE(canBePlaced(wall(40), TrackingConfig{})) << "a wall with something on it";
}

TEST(OwnView, NothingCannotBePlaced) {
  RgbdFrame frame = room().sequence.frame(0).frame;
  frame.depth.setTo(0);
  WorkingFrame working;
  working.assign(frame, cv::Mat(), FrameConfig{});
  EXPECT_FALSE(canBePlaced(working, TrackingConfig{}));
}

TEST(OwnView, WhatAMapAcceptsCanBePlaced) {
  // The map knows no more of a frame than the frame itself.
  PlaceVerifier verifier{TrackingConfig{}};
  int accepted = 0;
  for (int i = 0; i < room().sequence.frameCount(); ++i) {
    const WorkingFrame frame = room().frame(i);
    if (!verifier.verify(room().map, frame, {0, room().sequence.pose(i)}).accepted()) continue;
    ++accepted;
    EXPECT_TRUE(canBePlaced(frame, TrackingConfig{})) << i;
  }
  EXPECT_GT(accepted, 5);
}

}  // namespace
}  // namespace pf

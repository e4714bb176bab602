// SPDX-License-Identifier: BSD-3-Clause
// The calibration of fusion's depth camera: requested, kept from session to session, published.
#include <gtest/gtest.h>

#include <filesystem>
#include <future>

#include "../calibration_room.hpp"
#include "diagnostics_listener.hpp"
#include "fake_closer.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "saving_fixture.hpp"

namespace posefusion_ros {
namespace {

namespace fs = std::filesystem;

/// A small error of the camera of the empty room.
pf::DepthCalibration smallError() {
  pf::DepthCalibration calibration;
  calibration.name = "lab";
  calibration.camera = emptyRoom().frame(0).frame.camera.withoutDistortion();
  std::vector<double> nodes = pf::test::roomField().nodes();
  for (double& node : nodes) node *= 0.1;
  const pf::DepthField field = pf::test::roomField();
  calibration.field = {field.columns(), field.rows(), nodes};
  return calibration;
}

class ChainCalibration : public ChainSaving {
 protected:
  ChainCalibration() {
    chain.emplace(std::string("calibration_") +
                  testing::UnitTest::GetInstance()->current_test_info()->name());
    chain->set("output", folder / "out");
    chain->set("calibration_folder", folder / "cameras");
  }

  /// Of the frame of the test's images.
  std::string kept() const {
    return folder / ("cameras/" + std::string(frames::kOptical) + ".yaml");
  }

  /// Asks for a calibration while frames come, from that one on.
  std_srvs::TriggerResponse calibrate(int index) {
    auto asked = std::async(std::launch::async, [this] { return chain->call("calibrate"); });
    for (; index < 40; ++index) {
      process(index);
      if (asked.wait_for(std::chrono::milliseconds(100)) == std::future_status::ready) break;
    }
    return asked.get();
  }

  std::optional<pf::DepthCalibration> inSavedMap() {
    return pf::readSavedMap(folder / "out/latest/map.pfdb").calibration;
  }
};

TEST_F(ChainCalibration, TooFewKeyframesAreNamed) {
  chain->set("loop/answer_lag_s", 0.033);
  ASSERT_TRUE(chain->load());
  EXPECT_NE(chain->call("calibrate").message.find("there is no map"), std::string::npos);
  process(0);
  const auto answer = calibrate(1);
  EXPECT_FALSE(answer.success);
  EXPECT_NE(answer.message.find(" keyframes "), std::string::npos) << answer.message;
  EXPECT_NE(answer.message.find("pairs"), std::string::npos) << answer.message;
  EXPECT_FALSE(fs::exists(kept())) << "nothing was learned";
}

TEST_F(ChainCalibration, WhatIsLearnedIsPublishedAndKept) {
  FakeCloser closer(*chain);
  closer.finds([](const pf::LoopQuestion& question) {
    pf::LoopAnswer answer;
    answer.depth_version = question.depth_version;
    if (!question.calibrates) return answer;
    answer.calibration = smallError();
    answer.calibration->name.clear();
    return answer;
  });
  chain->set("camera_serial", std::string("12/34"));
  chain->set("loop/answer_lag_s", 0.033);
  const Diagnostics diagnostics(*chain);
  ASSERT_TRUE(chain->loadWithoutCloser());
  process(0);
  const auto answer = calibrate(1);
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_NE(answer.message.find("depth was off by"), std::string::npos) << answer.message;
  const pf::DepthCalibration kept = pf::loadCalibration(folder / "cameras/12_34.yaml");
  EXPECT_EQ(kept.name, "12/34");
  EXPECT_LT(pf::compare(kept.field, smallError().field).rms_difference, 1e-9);
  EXPECT_TRUE(diagnostics.waitFor("fusion", "depth corrected by", "learned"));
  EXPECT_EQ(diagnostics.value("fusion", "depth learned anew"), "1");
}

TEST_F(ChainCalibration, WithoutAFrameItFailsSoon) {
  ASSERT_TRUE(chain->load());
  process(0);
  const auto answer = chain->call("calibrate");
  EXPECT_FALSE(answer.success);
  EXPECT_NE(answer.message.find("no frame has come"), std::string::npos) << answer.message;
  ASSERT_TRUE(chain->call("pause").success);
  EXPECT_NE(chain->call("calibrate").message.find("paused"), std::string::npos);
}

TEST_F(ChainCalibration, UnloadingDoesNotWaitForTheCaller) {
  ASSERT_TRUE(chain->load());
  process(0);
  std_srvs::Trigger trigger;
  auto asked = std::async(std::launch::async, [&] {
    return ros::service::call(chain->space() + "/fusion/calibrate", trigger);
  });
  ros::WallDuration(0.2).sleep();
  chain->unload();
  // Where the connection went first there is no answer.
  if (asked.get()) {
    EXPECT_EQ(trigger.response.message, "shutting down");
  }
}

TEST_F(ChainCalibration, WhatDoesNotLearnReportsWhy) {
  chain->set("calibration/mode", std::string("frozen"));
  ASSERT_TRUE(chain->load());
  process(0);
  const auto answer = chain->call("calibrate");
  EXPECT_FALSE(answer.success);
  EXPECT_NE(answer.message.find("calibration.mode is frozen, expected learn"), std::string::npos)
      << answer.message;
}

TEST_F(ChainCalibration, WithoutALoopCloserItFails) {
  chain->set("closer_timeout_s", 0.1);
  ASSERT_TRUE(chain->loadWithoutCloser());
  process(0);
  const auto answer = calibrate(1);
  EXPECT_FALSE(answer.success);
  EXPECT_NE(answer.message.find("posefusion/loop_closer"), std::string::npos) << answer.message;
}

TEST_F(ChainCalibration, WhatIsKeptOfTheCameraIsUsedFromTheFirstFrameOn) {
  pf::makeFolder(folder / "cameras");
  pf::saveCalibration(kept(), smallError());
  const Diagnostics diagnostics(*chain);
  ASSERT_TRUE(chain->load());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(outcome(process(i)), TrackingStatusMsg::FUSED) << i;
  EXPECT_TRUE(diagnostics.waitFor("fusion", "depth corrected by", kept()));
  EXPECT_EQ(diagnostics.value("fusion", "depth learned anew"), "0");
  char amount_mm[32];
  std::snprintf(amount_mm, sizeof amount_mm, "%.1f", 4000 * smallError().field.rms());
  EXPECT_EQ(diagnostics.value("fusion", "depth correction at 2 m (mm)"), amount_mm);
  chain->unload();
  ASSERT_TRUE(inSavedMap());
  EXPECT_EQ(pf::calibrationText(*inSavedMap()), pf::calibrationText(smallError()));
}

TEST_F(ChainCalibration, AMapOfDepthAsMeasuredIsCorrectedByWhatIsKept) {
  const Diagnostics diagnostics(*chain);
  ASSERT_TRUE(chain->load());
  for (int i = 0; i < 3; ++i) process(i);
  EXPECT_TRUE(diagnostics.waitFor("fusion", "depth corrected by", "nothing"));
  chain->unload();
  EXPECT_FALSE(inSavedMap());
  const std::string map = folder / "map.pfdb";
  fs::copy(folder / "out/latest/map.pfdb", map);
  const std::string bytes = pf::readFile(map);

  pf::makeFolder(folder / "cameras");
  pf::saveCalibration(kept(), smallError());
  chain->set("map_file", map);
  chain->set("localize_only", true);  // nothing but the correction changes surfels
  ASSERT_TRUE(chain->load());
  TrackingStatusMsg status;
  for (int i = 3; i < 40 && status.state != TrackingStatusMsg::TRACKING; ++i) status = process(i);
  EXPECT_EQ(status.state, TrackingStatusMsg::TRACKING) << "it is found in the corrected map";
  EXPECT_TRUE(diagnostics.waitFor("fusion", "depth corrected by", kept()));
  ASSERT_TRUE(chain->call("save_map").success);
  ASSERT_TRUE(inSavedMap());
  EXPECT_EQ(pf::calibrationText(*inSavedMap()), pf::calibrationText(smallError()));
  const auto depths = [](const std::string& file) {
    return pf::readSavedMap(file).surfels.at(0).surfels.z;
  };
  const auto corrected = depths(folder / "out/latest/map.pfdb"), before = depths(map);
  EXPECT_EQ(corrected.size(), before.size());
  EXPECT_NE(corrected, before);
  chain->unload();
  EXPECT_EQ(pf::readFile(map), bytes) << "the file that it began in stays as it is";

  chain->set("localize_only", false);
  chain->set("continue_map", true);
  ASSERT_TRUE(chain->load());
  process(39);
  EXPECT_TRUE(diagnostics.waitFor("fusion", "depth corrected by", "nothing"))
      << "its file stays of one kind";
}

TEST_F(ChainCalibration, WhatDoesNotFitIsLeftOut) {
  pf::DepthCalibration other = smallError();
  other.camera.fx *= 1.3;
  pf::makeFolder(folder / "cameras");
  pf::saveCalibration(kept(), other);
  ASSERT_TRUE(chain->load());
  EXPECT_EQ(outcome(process(0)), TrackingStatusMsg::FUSED);
  chain->unload();
  EXPECT_FALSE(inSavedMap());
}

TEST_F(ChainCalibration, AFileThatWasNamedHasToFit) {
  pf::DepthCalibration other = smallError();
  other.camera.fx *= 1.3;
  pf::saveCalibration(folder / "other.yaml", other);
  chain->set("calibration_file", folder / "other.yaml");
  ASSERT_TRUE(chain->load());
  const TrackingStatusMsg status = process(0);
  EXPECT_EQ(outcome(status), TrackingStatusMsg::BAD_INPUT);
  EXPECT_NE(status.reason.find("the calibration of depth is of a camera of another view"),
            std::string::npos)
      << status.reason;
}

}  // namespace
}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/calibration_store.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include "../calibration_room.hpp"
#include "../temporary_folder.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/files.hpp"

namespace posefusion_ros {
namespace {

namespace fs = std::filesystem;

pf::DepthCalibration learned() {
  return {"", pf::test::roomCamera(640), pf::test::roomField(), 123, 1500, 7.25, 5.5, 0.0004};
}

/// An environment variable for as long as this lives; nullptr: not set.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_ ? before_->c_str() : nullptr); }

 private:
  void set(const char* value) {
    if (value == nullptr) {
      unsetenv(name_);
    } else {
      setenv(name_, value, 1);
    }
  }

  const char* name_;
  std::optional<std::string> before_;
};

std::string fileOf(const std::string& serial, const std::string& frame_id) {
  CalibrationStore store({"cameras", serial});
  store.setFrame(frame_id);
  return store.file();
}

TEST(CalibrationStore, GivesBackWhatItKeeps) {
  const pf::TemporaryFolder folder;
  CalibrationStore store({folder / "ros/cameras", "1234"});
  store.setFrame("camera_rgb_optical_frame");
  const pf::PinholeCamera camera = learned().camera;
  EXPECT_FALSE(store.find(camera)) << "nothing is kept";
  store.keep(learned());
  EXPECT_EQ(store.file(), folder / "ros/cameras/1234.yaml");
  pf::DepthCalibration named = learned();
  named.name = "1234";
  ASSERT_TRUE(store.find(camera));
  EXPECT_EQ(pf::calibrationText(*store.find(camera)), pf::calibrationText(named));
  EXPECT_TRUE(store.find(camera.shrunk(2))) << "another size of the same view";
  named.name = "lab";
  named.pairs = 1501;
  store.keep(named);
  EXPECT_EQ(pf::calibrationText(*store.find(camera)), pf::calibrationText(named));
}

TEST(CalibrationStore, TheSerialNumberNamesTheCameraElseItsFrame) {
  EXPECT_EQ(fileOf("", "camera_rgb_optical_frame"), "cameras/camera_rgb_optical_frame.yaml");
  EXPECT_EQ(fileOf("1234", "camera_rgb_optical_frame"), "cameras/1234.yaml");
  EXPECT_EQ(fileOf("", ""), "") << "no name at all";
}

TEST(CalibrationStore, NoNameLeadsOutOfTheFolder) {
  EXPECT_EQ(fileOf("", "/left/camera"), "cameras/_left_camera.yaml");
  EXPECT_EQ(fileOf("", ".."), "cameras/_..yaml");
  EXPECT_EQ(fileOf("../../etc/x y\n\xc3\xa9", ""), "cameras/_._.._etc_x_y___.yaml");
  EXPECT_EQ(fs::path(fileOf(std::string(1000, 'x'), "")).filename().string().size(), 205U);
}

TEST(CalibrationStore, WithoutAFolderNothingIsKept) {
  CalibrationStore store({"", "1234"});
  store.setFrame("camera");
  EXPECT_EQ(store.file(), "");
  store.keep(learned());
  EXPECT_FALSE(store.find(learned().camera));
}

TEST(CalibrationStore, WhatIsWrongNamesTheFile) {
  const pf::TemporaryFolder folder;
  CalibrationStore store({folder.str(), "1234"});
  store.setFrame("");
  store.keep(learned());
  pf::PinholeCamera other = learned().camera;
  other.fx *= 1.3;
  const auto find = [&](const pf::PinholeCamera& camera) {
    return pf::errorOf([&] { store.find(camera); });
  };
  EXPECT_EQ(find(other).rfind(store.file() + ": the calibration of depth is of a camera of", 0), 0U)
      << find(other);
  folder.write("1234.yaml", "nonsense");
  EXPECT_EQ(find(learned().camera).rfind(store.file(), 0), 0U) << find(learned().camera);
  CalibrationStore nowhere({folder / "1234.yaml/cameras", "5"});
  nowhere.setFrame("");
  EXPECT_NE(pf::errorOf([&] { nowhere.keep(learned()); }).find("1234.yaml/cameras"),
            std::string::npos);
}

TEST(CalibrationStore, IsBelowTheFolderOfRosByDefault) {
  const Variable home("HOME", "/tmp/me");
  {
    const Variable ros("ROS_HOME", "/tmp/ros");
    EXPECT_EQ(defaultCalibrationFolder(), "/tmp/ros/posefusion/cameras");
  }
  const Variable ros("ROS_HOME", nullptr);
  EXPECT_EQ(defaultCalibrationFolder(), "/tmp/me/.ros/posefusion/cameras");
  Parameters none(XmlRpc::XmlRpcValue(), "fusion");
  EXPECT_EQ(readCalibrationStore(none, true).folder, defaultCalibrationFolder());
  EXPECT_EQ(readCalibrationStore(none, false).folder, "");
  XmlRpc::XmlRpcValue values;
  values["calibration_folder"] = std::string("here");
  values["camera_serial"] = 1234;
  Parameters given(values, "fusion");
  EXPECT_EQ(readCalibrationStore(given, false).folder, "here");
  EXPECT_EQ(readCalibrationStore(given, true).serial, "1234");
  values["calibration_folder"] = std::string();
  Parameters off(values, "fusion");
  EXPECT_EQ(readCalibrationStore(off, true).folder, "");
  const Variable lost("HOME", nullptr);
  EXPECT_EQ(defaultCalibrationFolder(), "");
}

}  // namespace
}  // namespace posefusion_ros

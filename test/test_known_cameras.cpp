// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/known_cameras.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/images.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

double fxOf(const std::string& folder) {
  const auto known = knownCamera(folder);
  return known ? known->file.camera.fx : 0;
}

TEST(KnownCameras, AreRecognisedByTheFoldersName) {
  EXPECT_EQ(fxOf("data/rgbd_dataset_freiburg1_desk"), 517.3);
  EXPECT_EQ(fxOf("data/rgbd_dataset_freiburg2_xyz/"), 520.9) << "a slash at the end";
  EXPECT_EQ(fxOf("fr3/walking_xyz"), 535.4) << "of the folder around it";
  EXPECT_EQ(fxOf("fr3_walking_xyz"), 535.4);
  EXPECT_EQ(fxOf("/data/TUM/Freiburg3/w_xyz/."), 535.4);
  EXPECT_EQ(fxOf("rgbd_bonn_crowd2"), 542.822841);
  for (const char* other : {"kitchen", "my_fr3", "fr10", "freiburg", "bonn", "."}) {
    EXPECT_EQ(fxOf(other), 0) << other;
  }
}

TEST(KnownCameras, AreWhole) {
  for (const char* name : {"fr1", "fr2", "fr3", "rgbd_bonn_crowd"}) {
    const CameraFile file = knownCamera(name)->file;
    validate(file.camera);
    EXPECT_EQ(file.depth_factor, 5000) << name;
    EXPECT_EQ(file.camera.isDistorted(), std::string(name) != "fr3") << name;
  }
}

/// A folder as the archives have it: no associations, no camera, comments, truth with a gap.
class ArchiveTest : public testing::Test {
 protected:
  ArchiveTest() : folder(root / "rgbd_dataset_freiburg3_walking_xyz") {
    const std::string name = "rgbd_dataset_freiburg3_walking_xyz/";
    std::string color = "# color images\n# file: 'x.bag'\n# timestamp filename\n", depth = color;
    for (int i = 0; i < 3; ++i) {
      const std::string at = "134184" + std::to_string(i) + ".000000";
      color += at + " rgb/" + at + ".png\r\n";
      depth += "134184" + std::to_string(i) + ".012000 depth/" + at + ".png\n";
      std::filesystem::create_directories(folder + "/rgb");
      std::filesystem::create_directories(folder + "/depth");
      savePng(folder + "/rgb/" + at + ".png", cv::Mat(480, 640, CV_8UC3, cv::Scalar(9, 8, 7)));
      savePng(folder + "/depth/" + at + ".png", cv::Mat(480, 640, CV_16UC1, cv::Scalar(5000)));
    }
    root.write(name + "rgb.txt", color);
    root.write(name + "depth.txt", depth);
    root.write(name + "groundtruth.txt",
               "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n"
               "1341840.0010 1 2 3 0 0 0 1\n1341842.0010 1 2 4 0 0 0 1\n");
  }

  TemporaryFolder root;
  std::string folder;
};

TEST_F(ArchiveTest, IsReadAsItIs) {
  for (const std::string& path : {folder, folder + "/", folder + "//"}) {
    const auto source = openTumFolder(path);
    const auto first = source->next();
    ASSERT_TRUE(first) << path;
    EXPECT_EQ(first->defect, "");
    EXPECT_EQ(first->frame.camera.fy, 539.2);
    EXPECT_DOUBLE_EQ(first->frame.depth_unit_m * first->frame.depth.at<std::uint16_t>(9, 9), 1.0);
    EXPECT_EQ(source->frameCount(), 3U);
    EXPECT_EQ(source->truth().size(), 2U);
    ASSERT_EQ(source->report().notes.size(), 1U);
    EXPECT_NE(source->report().notes[0].find("TUM fr3"), std::string::npos);
  }
}

TEST_F(ArchiveTest, ItsOwnCameraComesFirst) {
  root.write("rgbd_dataset_freiburg3_walking_xyz/camera.yaml",
             "{width: 640, height: 480, fx: 500, fy: 501, cx: 320, cy: 240, depth_factor: 1000}");
  EXPECT_EQ(openTumFolder(folder)->next()->frame.camera.fx, 500);
  EXPECT_TRUE(openTumFolder(folder)->report().notes.empty());
  EXPECT_NE(errorOf([&] { openTumFolder(folder, root / "none.yaml"); }).find("is missing"),
            std::string::npos)
      << "a file that is named is not replaced by a guess";
}

}  // namespace
}  // namespace pf

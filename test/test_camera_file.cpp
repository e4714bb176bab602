// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/camera_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "posefusion/core/error.hpp"
#include "small_camera.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

TEST(CameraFile, ReadsOtherToolsFiles) {
  TemporaryFolder folder;
  const auto ros = folder.write("ros.yaml",
                                "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n"
                                "  cols: 3\n  data: [570, 0, 314, 0, 571, 239, 0, 0, 1]\n"
                                "distortion_coefficients:\n  rows: 1\n  cols: 5\n"
                                "  data: [0.1, -0.2, 0.001, 0.002, 0]\n");
  EXPECT_EQ(loadCamera(ros).camera.fy, 571);
  EXPECT_EQ(loadCamera(ros).camera.distortion[1], -0.2);
  EXPECT_FALSE(loadCamera(ros).depth_factor.has_value());
  const auto opencv = folder.write(
      "cv.yaml",
      "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n"
      "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 570., 0., 314., 0., 571., 239., 0., 0., 1. "
      "]\n");
  EXPECT_EQ(loadCamera(opencv).camera.cx, 314);
  const auto orb = folder.write("orb.yaml",
                                "%YAML:1.0\nCamera.fx: 535.4\nCamera.fy: 539.2\nCamera.cx: 320.1\n"
                                "Camera.cy: 247.6\nCamera.width: 640\nCamera.height: 480\n"
                                "DepthMapFactor: 5000.0\n");
  EXPECT_EQ(loadCamera(orb).camera.cy, 247.6);
  EXPECT_EQ(*loadCamera(orb).depth_factor, 5000);
}

TEST(CameraFile, SavedFileReadsBackAsTheSame) {
  TemporaryFolder folder;
  CameraFile file{smallCamera(), 5000.0};
  file.camera.fx = 100.0 / 3.0;
  const auto expectSame = [&] {
    saveCamera(folder / "c.yaml", file);
    EXPECT_EQ(loadCamera(folder / "c.yaml").camera, file.camera);
    EXPECT_EQ(loadCamera(folder / "c.yaml").depth_factor, file.depth_factor);
  };
  expectSame();
  file.camera.distortion = {0.1, 0.2, 0.3, 0.4, 0.5};
  expectSame();
  file.camera.distortion = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  expectSame();
  file.camera.distortion = {0.1, 0.2, 0.3, 0.4};
  file.camera.lens = LensModel::kEquidistant;
  expectSame();
  file.camera.distortion = {};
  expectSame();
  file.sensor_kind = "active_stereo";
  expectSame();
  EXPECT_EQ(loadCamera(folder / "c.yaml").sensor_kind, "active_stereo");
}

TEST(CameraFile, HasTheColourCameraWhereColourIsNotRegistered) {
  TemporaryFolder folder;
  CameraFile file{smallCamera(), 5000.0};
  saveCamera(folder / "c.yaml", file);
  EXPECT_FALSE(loadCamera(folder / "c.yaml").color.has_value());
  file.color = ColorCamera{526.5, 527.5, 319, 240, -0.025};
  saveCamera(folder / "c.yaml", file);
  const auto color = loadCamera(folder / "c.yaml").color;
  ASSERT_TRUE(color.has_value());
  EXPECT_EQ(color->fx, 526.5);
  EXPECT_EQ(color->fy, 527.5);
  EXPECT_EQ(color->cx, 319);
  EXPECT_EQ(color->cy, 240);
  EXPECT_EQ(color->depth_right_m, -0.025);
}

TEST(CameraFile, AColourCameraThatCannotBeIsNamed) {
  TemporaryFolder folder;
  const auto said = [&](const std::string& color) -> std::string {
    const auto path = folder.write(
        "c.yaml", "width: 640\nheight: 480\nfx: 300\nfy: 300\ncx: 320\ncy: 240\n" + color);
    try {
      loadCamera(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_NE(said("color_fx: 300\n").find("color_fy is missing"), std::string::npos);
  const std::string rest = "color_fy: 300\ncolor_cx: 320\ncolor_cy: 240\n";
  EXPECT_NE(said("color_fx: -1\n" + rest).find("focal length of colour is -1"), std::string::npos);
  EXPECT_NE(said("color_fx: 300\ncolor_depth_right_m: 25\n" + rest).find("expected metres"),
            std::string::npos);
  EXPECT_NE(said("color_fx: many\n" + rest).find("color_fx is no number"), std::string::npos);
}

TEST(CameraFile, TheLensModelDefinesTheCoefficients) {
  TemporaryFolder folder;
  const auto load = [&](const std::string& lens) {
    return loadCamera(
               folder.write("c.yaml",
                            "width: 640\nheight: 480\nfx: 300\nfy: 300\ncx: 320\ncy: 240\n" + lens))
        .camera;
  };
  const auto rational = load(
      "distortion_model: rational_polynomial\ndistortion_coefficients: "
      "{data: [1, 2, 3, 4, 5, 6, 7, 8]}\n");
  EXPECT_EQ(rational.distortion, (std::array<double, 8>{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(rational.lens, LensModel::kPolynomial);
  EXPECT_EQ(load("k3: 0.5\n").distortion[4], 0.5);
  for (const char* name : {"distortion_model: equidistant", "Camera.type: \"KannalaBrandt8\""}) {
    const auto fisheye = load(std::string(name) + "\nk3: 0.5\n");
    EXPECT_EQ(fisheye.lens, LensModel::kEquidistant) << name;
    EXPECT_EQ(fisheye.distortion[2], 0.5) << name;
  }
  const auto error = [&](const std::string& lens) { return errorOf([&] { load(lens); }); };
  EXPECT_NE(error("distortion_model: omni\n").find("is 'omni', expected plumb_bob"),
            std::string::npos);
  EXPECT_NE(error("distortion_model: equidistant\ndistortion_coefficients: [1, 2, 3, 4, 5]\n")
                .find("5 values, expected at most 4: k1 k2 k3 k4"),
            std::string::npos);
}

}  // namespace
}  // namespace pf

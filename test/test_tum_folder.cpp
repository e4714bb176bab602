// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "posefusion/core/error.hpp"
#include "posefusion/io/camera_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/tum_writer.hpp"
#include "posefusion/run/run.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace pf {
namespace {

PinholeCamera camera() {
  PinholeCamera c;
  c.width = 64;
  c.height = 48;
  c.fx = c.fy = 60;
  c.cx = 31.5;
  c.cy = 23.5;
  return c;
}

RgbdFrame frameAt(std::int64_t stamp_ns) {
  RgbdFrame frame;
  frame.stamp_ns = stamp_ns;
  frame.camera = camera();
  frame.color.create(48, 64, CV_8UC3);
  frame.depth.create(48, 64, CV_16UC1);
  cv::RNG random(static_cast<std::uint64_t>(stamp_ns));
  random.fill(frame.color, cv::RNG::UNIFORM, 0, 256);
  random.fill(frame.depth, cv::RNG::UNIFORM, 500, 4000);
  return frame;
}

bool samePixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// A written sequence of four frames, 0.1 s apart from 1.0 s on.
class TumFolderTest : public testing::Test {
 protected:
  TumFolderTest() : folder(root / "sequence") {
    TumWriter writer(folder, camera());
    for (int i = 0; i < 4; ++i) {
      writer.add(frameAt(stamp(i)));
      StampedPose pose;
      pose.stamp_ns = stamp(i);
      pose.T_world_camera.translation().x() = 0.1 * i;
      writer.addTruth(pose);
    }
    People people;
    people.stamp_ns = stamp(1);
    people.detected = true;
    people.people.resize(1);
    people.people[0].joints[4] = {12.25F, 13.1F, 0.7F};
    people.people[0].score = 0.3F;
    writer.addPeople(people);
    writer.finish();
  }

  static std::int64_t stamp(int i) { return 1'000'000'000 + i * 100'000'000LL; }
  std::string file(const std::string& name) const { return folder + "/" + name; }

  std::vector<SourceFrame> readAll(InputReport* report = nullptr) const {
    auto source = openTumFolder(folder);
    std::vector<SourceFrame> frames;
    while (auto frame = source->next()) frames.push_back(*frame);
    EXPECT_EQ(frames.size(), source->frameCount());
    if (report != nullptr) *report = source->report();
    return frames;
  }

  TemporaryFolder root;
  std::string folder;
};

TEST_F(TumFolderTest, ReadsWhatTheWriterWrote) {
  const auto frames = readAll();
  ASSERT_EQ(frames.size(), 4U);
  for (int i = 0; i < 4; ++i) {
    const auto& [frame, defect] = frames[static_cast<std::size_t>(i)];
    const RgbdFrame expected = frameAt(stamp(i));
    EXPECT_EQ(defect, "");
    EXPECT_EQ(frame.stamp_ns, expected.stamp_ns);
    EXPECT_EQ(frame.camera, expected.camera);
    EXPECT_DOUBLE_EQ(frame.depth_unit_m, 1e-3);
    EXPECT_TRUE(samePixels(frame.color, expected.color)) << "colours stay R G B";
    EXPECT_TRUE(samePixels(frame.depth, expected.depth));
  }
  auto source = openTumFolder(folder);
  ASSERT_EQ(source->truth().size(), 4U);
  EXPECT_DOUBLE_EQ(source->truth()[3].T_world_camera.translation().x(), 0.3);
  const auto people = source->people();
  ASSERT_EQ(people.count(stamp(1)), 1U);
  EXPECT_EQ(people.at(stamp(1)).people[0].joints[4].v, 13.1F);
}

TEST_F(TumFolderTest, ListsAreMatchedWhereThereAreNoAssociations) {
  std::filesystem::remove(file("associations.txt"));
  root.write("sequence/depth.txt",
             "1.005 depth/1.000000.png\n1.099 depth/1.100000.png\n1.25 depth/1.200000.png\n");
  InputReport report;
  const auto frames = readAll(&report);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].frame.stamp_ns, stamp(1)) << "the stamp is that of the colour image";
  EXPECT_TRUE(samePixels(frames[1].frame.depth, frameAt(stamp(1)).depth));
  EXPECT_EQ(report.color_without_depth, 2U);
  EXPECT_EQ(report.depth_without_color, 1U);
}

TEST_F(TumFolderTest, AssociationsMayNameDepthFirst) {
  root.write("sequence/associations.txt", "1.01 depth/1.000000.png 1.0 rgb/1.000000.png\n");
  const auto frames = readAll();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].defect, "");
  EXPECT_EQ(frames[0].frame.stamp_ns, stamp(0));
}

TEST_F(TumFolderTest, DepthUnitAndDistortionComeFromTheCameraFile) {
  root.write("sequence/camera.yaml",
             "{width: 64, height: 48, fx: 60, fy: 61, cx: 31.5, cy: 23.5, k1: 0.1, p2: -0.01, "
             "depth_factor: 5000}");
  const auto frame = readAll()[0].frame;
  EXPECT_DOUBLE_EQ(frame.depth_unit_m, 1.0 / 5000);
  EXPECT_EQ(frame.camera.distortion, (std::array<double, 8>{0.1, 0, 0, -0.01}));
}

TEST_F(TumFolderTest, TheCameraFileNamesTheKindOfSensor) {
  const std::string camera =
      "width: 64\nheight: 48\nfx: 60\nfy: 61\ncx: 31.5\ncy: 23.5\ndepth_factor: 5000\n";
  const auto sourceOf = [&](const std::string& more) {
    root.write("sequence/camera.yaml", camera + more);
    return openTumFolder(root / "sequence");
  };
  EXPECT_EQ(sourceOf("")->sensorKind(), "");
  const auto flight = sourceOf("sensor: time_of_flight\n");
  EXPECT_EQ(flight->sensorKind(), "time_of_flight");
  Config config;
  EXPECT_EQ(configFor(config, *sourceOf("")).sensor.kind, "auto");
  EXPECT_EQ(configFor(config, *flight).sensor.kind, "time_of_flight");
  config.sensor.kind = "structured_light";
  EXPECT_EQ(configFor(config, *flight).sensor.kind, "structured_light") << "what is set holds";
  try {
    sourceOf("sensor: lidar\n");
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), (root / "sequence/camera.yaml") +
                                ": sensor is 'lidar', expected one of structured_light, "
                                "time_of_flight, active_stereo");
  }
}

TEST_F(TumFolderTest, ADamagedImageIsADefectOfItsFrameAlone) {
  const std::string whole = readFile(file("depth/1.100000.png"));
  root.write("sequence/depth/1.100000.png", whole.substr(0, whole.size() / 2));
  std::filesystem::remove(file("rgb/1.200000.png"));
  const auto frames = readAll();
  EXPECT_EQ(frames[0].defect, "");
  EXPECT_EQ(frames[1].defect, "depth/1.100000.png: is not a whole image");
  EXPECT_TRUE(frames[1].frame.depth.empty());
  EXPECT_NE(frames[2].defect.find("1.200000.png: cannot be opened"), std::string::npos);
  EXPECT_EQ(frames[3].defect, "");
}

TEST_F(TumFolderTest, ACutJpegIsNotTakenForAnImage) {
  const std::string path = testData("kitchen_static/rgb/1.000000.jpg");
  POSEFUSION_REQUIRE_DATA(path);
  const std::string whole = readFile(path);
  EXPECT_EQ(decodeColor(whole.data(), whole.size()).rows, 480);
  for (const std::size_t size : {0UL, 2UL, 1000UL, whole.size() / 2, whole.size() - 2}) {
    EXPECT_TRUE(decodeColor(whole.data(), size).empty()) << size << " bytes";
  }
}

TEST_F(TumFolderTest, AFrameOfAnotherSizeIsADefect) {
  savePng(file("rgb/1.000000.png"), cv::Mat(24, 32, CV_8UC3, cv::Scalar(1, 2, 3)));
  savePng(file("rgb/1.100000.png"), cv::Mat(24, 32, CV_8UC3, cv::Scalar(1, 2, 3)));
  savePng(file("depth/1.100000.png"), cv::Mat(24, 32, CV_16UC1, cv::Scalar(1000)));
  const auto frames = readAll();
  EXPECT_NE(frames[0].defect.find("colour is 32x24 but depth is 64x48"), std::string::npos);
  EXPECT_NE(frames[1].defect.find("the images are 32x24 but the camera is 64x48"),
            std::string::npos);
  EXPECT_EQ(frames[2].defect, "");
}

TEST_F(TumFolderTest, StampsGoingBackAreDefects) {
  root.write("sequence/associations.txt",
             "1.0 rgb/1.000000.png 1.0 depth/1.000000.png\n"
             "1.2 rgb/1.200000.png 1.2 depth/1.200000.png\n"
             "1.1 rgb/1.100000.png 1.1 depth/1.100000.png\n"
             "1.3 rgb/1.300000.png 1.3 depth/1.300000.png\n");
  const auto frames = readAll();
  EXPECT_EQ(frames[1].defect, "");
  EXPECT_EQ(frames[2].defect, "stamp 1.100000 is not later than 1.200000 before it");
  EXPECT_EQ(frames[3].defect, "");
}

TEST_F(TumFolderTest, AStampOfTheFutureCostsItsOwnFrameAlone) {
  root.write("sequence/associations.txt",
             "1.0 rgb/1.000000.png 1.0 depth/1.000000.png\n"
             "5000 rgb/1.100000.png 5000 depth/1.100000.png\n"
             "1.2 rgb/1.200000.png 1.2 depth/1.200000.png\n"
             "1.3 rgb/1.300000.png 1.3 depth/1.300000.png\n");
  const auto frames = readAll();
  EXPECT_EQ(frames[1].defect, "stamp 5000.000000 is later than those of the frames after it");
  EXPECT_EQ(frames[2].defect, "");
  EXPECT_EQ(frames[3].defect, "");
}

TEST_F(TumFolderTest, AWordThatIsNoStampIsNamedWithFileAndLine) {
  root.write("sequence/associations.txt", "# a\n1.0 rgb/1.000000.png garbage depth/1.000000.png\n");
  EXPECT_EQ(errorOf([&] { openTumFolder(folder); }), "");  // only the colour's stamp is used
  root.write("sequence/associations.txt", "# a\ngarbage rgb/1.000000.png 1 depth/1.000000.png\n");
  EXPECT_NE(errorOf([&] {
              openTumFolder(folder);
            }).find("associations.txt:2: 'garbage' is no stamp, expected decimal seconds"),
            std::string::npos);
}

TEST_F(TumFolderTest, ErrorsNameWhatIsMissing) {
  const auto error = [&](const std::string& path) { return errorOf([&] { openTumFolder(path); }); };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(error("/nowhere"), "/nowhere: is no folder");
  std::filesystem::create_directory(root / "empty");
  EXPECT_TRUE(has(error(root / "empty"), "expected associations.txt, or rgb.txt and depth.txt"));
  root.write("sequence/associations.txt", "# nothing\n");
  EXPECT_TRUE(has(error(folder), "lists no pair"));
  root.write("sequence/associations.txt", "1.0 rgb/1.000000.png\n");
  EXPECT_TRUE(has(error(folder), "associations.txt:1: expected 4 columns"));
  std::filesystem::remove(file("associations.txt"));
  root.write("sequence/camera.yaml", "{width: 64, height: 48, fx: 0, fy: 1, cx: 1, cy: 1}");
  EXPECT_TRUE(has(error(folder), "fx is 0.000000, expected a focal length above 0"));
  root.write("sequence/camera.yaml", "{width: 64, height: 48, fx: 60, fy: 60, cx: 1, cy: 1}");
  EXPECT_TRUE(has(error(folder), "depth_factor is missing"));
  root.write("sequence/camera.yaml", "{width: 64, height: 48, fx: 60, cx: 1, cy: 1}");
  EXPECT_TRUE(has(error(folder), "fy is missing"));
  std::filesystem::remove(file("camera.yaml"));
  EXPECT_TRUE(has(error(folder), "camera.yaml: is missing"));
}

TEST_F(TumFolderTest, FloatDepthIsStoredInTheFolderUnit) {
  RgbdFrame frame = frameAt(1);
  frame.depth = cv::Mat(48, 64, CV_32FC1, cv::Scalar(1.2344F));
  frame.depth.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  frame.depth.at<float>(0, 1) = 100.0F;  // more than 16 bits of millimetres
  TumWriter writer(root / "float", camera());
  writer.add(frame);
  writer.finish();
  const cv::Mat depth = openTumFolder(root / "float")->next()->frame.depth;
  EXPECT_EQ(depth.at<std::uint16_t>(5, 5), 1234);
  EXPECT_EQ(depth.at<std::uint16_t>(0, 0), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(0, 1), 0);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>

#include "device_fixture.hpp"

namespace pf::openni2 {
namespace {

namespace fs = std::filesystem;

/// Files recorded from the virtual camera by OpenNI2's own recorder.
class DeviceFile : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    char name[] = "/tmp/posefusion_oni_XXXXXX";
    folder_ = mkdtemp(name);
    path_ = (folder_ / "recorded.oni").string();
  }
  void TearDown() override {
    fs::remove_all(folder_);
    DeviceTest::TearDown();
  }

  /// Records at least n frames of each stream; returns what the sink has got meanwhile.
  void record(FrameKeeper& keeper, std::size_t n) {
    DeviceSettings settings;
    settings.color_mode = settings.depth_mode = {320, 240, 60};
    Device device(settings, keeper.sink());
    ASSERT_TRUE(keeper.waitFor(2));
    device.startRecording(path_);
    EXPECT_EQ(device.recordingPath(), path_);
    EXPECT_FALSE(fs::exists(path_)) << "it has a temporary name while it grows";
    ASSERT_TRUE(keeper.waitFor(keeper.count(StreamKind::color) + n));
    EXPECT_EQ(device.stopRecording(), path_);
    EXPECT_EQ(device.recordingPath(), "");
  }
  DeviceSettings playing(double speed, bool repeat) const {
    DeviceSettings settings;
    settings.device = path_;
    settings.file_speed = speed;
    settings.file_repeat = repeat;
    return settings;
  }

  fs::path folder_;
  std::string path_;
};

/// The index of the served frame that has these pixels; -1 for none.
int servedIndex(StreamKind kind, const KeptFrame& frame, int from, int to) {
  for (int index = from; index <= to; ++index) {
    if (frame.pixels == servedPixels(kind, frame, index)) return index;
  }
  return -1;
}

TEST_F(DeviceFile, PlaysEveryRecordedPixelInOrder) {
  FrameKeeper live;
  record(live, 30);
  EXPECT_FALSE(fs::exists(path_ + ".part"));
  FrameKeeper played;
  Device device(playing(1, false), played.sink());
  EXPECT_TRUE(device.identity().is_file);
  EXPECT_EQ(device.stream(StreamKind::color).mode, StreamMode({320, 240, 60}));
  EXPECT_NEAR(160 / std::tan(device.stream(StreamKind::color).horizontal_fov_rad / 2), 262.5, 1e-3);
  ASSERT_TRUE(eventually([&] { return device.hasEnded(); }));
  for (const auto kind : {StreamKind::color, StreamKind::depth}) {
    const auto frames = played.frames(kind);
    ASSERT_GE(frames.size() + device.counters(kind).dropped, 25u);
    ASSERT_GE(frames.size(), 20u) << "a busy machine may lose some";
    const int first = servedIndex(kind, frames[0], 1, live.frames(kind).back().index);
    ASSERT_GT(first, 0) << nameOf(kind) << ": the first frame is none of those served";
    for (const auto& frame : frames) {
      // The file counts its frames from 1 and its time from 0.
      const int served = first + frame.index - frames[0].index;
      EXPECT_EQ(frame.pixels, servedPixels(kind, frame, served)) << nameOf(kind) << frame.index;
      EXPECT_NEAR(static_cast<double>(frame.device_time_us - frames[0].device_time_us),
                  (served - first) * 1e6 / 60, 2.0);
    }
  }
}

TEST_F(DeviceFile, PlaysAsFastAsItWasRecordedAndEnds) {
  FrameKeeper live;
  record(live, 30);
  FrameKeeper played;
  Device device(playing(1, false), played.sink());
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(device.hasEnded());
  ASSERT_TRUE(eventually([&] { return device.hasEnded(); }));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  EXPECT_GT(taken.count(), 0.35) << "30 frames at 60 Hz";
  EXPECT_TRUE(device.apply({}).empty());
}

TEST_F(DeviceFile, IsRepeatedOnRequest) {
  FrameKeeper live;
  record(live, 30);
  FrameKeeper played;
  Device device(playing(1, true), played.sink());
  ASSERT_TRUE(played.waitFor(70)) << "more frames than were recorded";
  EXPECT_FALSE(device.hasEnded());
}

TEST_F(DeviceFile, IsFinishedWhenTheDeviceIsClosed) {
  FrameKeeper keeper;
  {
    Device device({}, keeper.sink());
    device.startRecording(path_);
    ASSERT_TRUE(keeper.waitFor(5));
  }
  ASSERT_TRUE(fs::exists(path_));
  FrameKeeper played;
  Device device(playing(1, false), played.sink());
  EXPECT_TRUE(played.waitFor(3));
}

TEST_F(DeviceFile, KeepsWhatWasRecordedBeforeTheCameraWasUnplugged) {
  FrameKeeper keeper;
  {
    Device device({}, keeper.sink());
    device.startRecording(path_);
    ASSERT_TRUE(keeper.waitFor(5));
    virtualDevice().plug(false);
    ASSERT_TRUE(eventually([&] { return !device.isConnected(); }));
  }
  FrameKeeper played;
  Device device(playing(1, false), played.sink());
  EXPECT_TRUE(played.waitFor(3));
}

// OpenNI2's recorder takes its orders in a thread of its own: a start that it comes to after it was
// stopped makes it record while it is destroyed, which hangs.
TEST_F(DeviceFile, CanBeEndedAtOnce) {
  FrameKeeper keeper;
  virtualDevice().notify_ms = 50;
  Device device({}, keeper.sink());
  for (int i = 0; i < 10; ++i) {
    device.startRecording(path_);
    EXPECT_EQ(device.stopRecording(), path_);
  }
}

TEST_F(DeviceFile, ReportsWhyItCannotBeRecorded) {
  FrameKeeper keeper;
  Device device({}, keeper.sink());
  const std::string missing = (folder_ / "no/such/folder.oni").string();
  EXPECT_TRUE(contains(errorOf([&] { device.startRecording(missing); }), missing));
  EXPECT_TRUE(contains(errorOf([&] { device.startRecording(missing); }), "No such file"));
  device.startRecording(path_);
  EXPECT_TRUE(contains(errorOf([&] { device.startRecording(path_); }), "runs already"));
  EXPECT_EQ(device.stopRecording(), path_);
  EXPECT_EQ(device.stopRecording(), "");
}

TEST_F(DeviceFile, ReportsWhyItCannotBePlayed) {
  const auto error = [&] {
    return errorOf([&] { Device(playing(1, false), [](const SensorFrame&) {}); });
  };
  EXPECT_TRUE(contains(error(), path_ + "': no such file"));
  std::ofstream(path_) << "This is no recording.";
  EXPECT_TRUE(contains(error(), path_));
}

}  // namespace
}  // namespace pf::openni2

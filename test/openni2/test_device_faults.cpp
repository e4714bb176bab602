// SPDX-License-Identifier: BSD-3-Clause
#include "device_fixture.hpp"

namespace pf::openni2 {
namespace {

class DeviceFaults : public DeviceTest {
 protected:
  std::string openingError(const DeviceSettings& settings = {}) {
    return errorOf([&] { Device(settings, [](const SensorFrame&) {}); });
  }
  /// Every frame that came is whole and comes once.
  void expectCleanFrames() {
    for (const auto kind : {StreamKind::color, StreamKind::depth}) {
      int last = 0;
      for (const auto& frame : keeper_.frames(kind)) {
        EXPECT_EQ(frame.pixels, servedPixels(kind, frame, frame.index));
        EXPECT_GT(frame.index, last);
        last = frame.index;
      }
    }
  }

  FrameKeeper keeper_;
};

TEST_F(DeviceFaults, ListsWhatIsOfferedForAModeThatIsNot) {
  DeviceSettings settings;
  settings.color_mode = {1920, 1080, 30};
  std::string error = openingError(settings);
  EXPECT_TRUE(contains(error, "no colour mode 1920x1080@30"));
  EXPECT_TRUE(contains(error, "640x480@30 RGB"));
  EXPECT_TRUE(contains(error, "640x480@30 YUV422"));
  EXPECT_TRUE(contains(error, "1280x1024@30 RGB"));
  settings.color_mode = {};
  settings.depth_mode = {1280, 1024, 30};
  error = openingError(settings);
  EXPECT_TRUE(contains(error, "no depth mode 1280x1024@30"));
  EXPECT_TRUE(contains(error, "320x240@60 1 mm"));
}

TEST_F(DeviceFaults, ListsWhatIsOfferedWhenAModeIsRefused) {
  virtualDevice().refuses_modes = true;
  const std::string error = openingError();
  EXPECT_TRUE(contains(error, "refuses the colour mode 640x480@30"));
  EXPECT_TRUE(contains(error, "320x240@30 RGB"));
}

TEST_F(DeviceFaults, NamesWhatItLookedForWhenNoneIsThere) {
  virtualDevice().plug(false);
  EXPECT_TRUE(contains(openingError(), "looked for any camera; no camera is connected"));
}

TEST_F(DeviceFaults, NamesTheOthersWhenTheWantedIsNotThere) {
  DeviceSettings settings;
  settings.device = "V0009";
  EXPECT_TRUE(contains(openingError(settings), "'V0009'"));
  EXPECT_TRUE(contains(openingError(settings), "virtual/0 has V0001"));
  settings.device = "#2";
  EXPECT_TRUE(contains(openingError(settings), "camera #2"));
  EXPECT_TRUE(contains(openingError(settings), "posefusion virtual camera (virtual/0)"));
}

TEST_F(DeviceFaults, GivesTheDriversReasonWhenItDoesNotOpen) {
  virtualDevice().refuses_open = true;
  EXPECT_TRUE(contains(openingError(), "'virtual/0'"));
  EXPECT_TRUE(contains(openingError(), "the virtual camera refuses to open"));
}

TEST_F(DeviceFaults, RefusesADeviceThatCannotRegister) {
  virtualDevice().refuses_registration = true;
  EXPECT_TRUE(contains(openingError(), "depth_registration"));
  DeviceSettings settings;
  settings.depth_registration = false;
  EXPECT_EQ(openingError(settings), "");
}

TEST_F(DeviceFaults, RefusesADeviceThatMirrors) {
  virtualDevice().keeps_mirroring = true;
  EXPECT_TRUE(contains(openingError(), "mirroring"));
}

TEST_F(DeviceFaults, CountsDuplicatesAndPassesThemOnce) {
  virtualDevice().duplicate_every = 3;
  Device device({}, keeper_.sink());
  ASSERT_TRUE(keeper_.waitFor(10));
  EXPECT_GE(device.counters(StreamKind::color).duplicated, 2u);
  EXPECT_GE(device.counters(StreamKind::depth).duplicated, 2u);
  expectCleanFrames();
}

TEST_F(DeviceFaults, CountsShortFramesAndPassesNone) {
  virtualDevice().short_every = 3;
  Device device({}, keeper_.sink());
  ASSERT_TRUE(keeper_.waitFor(10));
  EXPECT_GE(device.counters(StreamKind::color).damaged, 3u);
  EXPECT_GE(device.counters(StreamKind::depth).damaged, 3u);
  for (const auto& frame : keeper_.frames(StreamKind::depth)) EXPECT_NE(frame.index % 3, 0);
  expectCleanFrames();
}

TEST_F(DeviceFaults, CountsWhatIsMissing) {
  virtualDevice().drop_every = 4;
  Device device({}, keeper_.sink());
  ASSERT_TRUE(keeper_.waitFor(12));
  EXPECT_GE(device.counters(StreamKind::color).dropped, 3u);
  EXPECT_GE(device.counters(StreamKind::depth).dropped, 3u);
  expectCleanFrames();
}

TEST_F(DeviceFaults, LateFramesKeepTheirTime) {
  virtualDevice().late_every = 4;
  virtualDevice().late_by_ms = 25;
  Device device({}, keeper_.sink());
  ASSERT_TRUE(keeper_.waitFor(10));
  for (const auto& frame : keeper_.frames(StreamKind::color)) {
    EXPECT_EQ(frame.device_time_us, virtualTimeUs(frame.index, 30));
  }
  expectCleanFrames();
}

TEST_F(DeviceFaults, AStallIsSeen) {
  Device device({}, keeper_.sink());
  ASSERT_TRUE(keeper_.waitFor(5));
  EXPECT_LT(device.silence_s(), 0.5);
  virtualDevice().stalled = true;
  EXPECT_TRUE(eventually([&] { return device.silence_s() > 0.6; }));
  EXPECT_TRUE(device.isConnected());
  virtualDevice().stalled = false;
  EXPECT_TRUE(eventually([&] { return device.silence_s() < 0.2; }));
}

TEST_F(DeviceFaults, IsOpenedAgainAfterItWasUnplugged) {
  for (int round = 0; round < 5; ++round) {
    FrameKeeper keeper;
    {
      Device device({}, keeper.sink());
      ASSERT_TRUE(keeper.waitFor(3));
      EXPECT_TRUE(device.isConnected());
      virtualDevice().plug(false);
      EXPECT_TRUE(eventually([&] { return !device.isConnected(); }));
    }
    EXPECT_TRUE(contains(openingError(), "no camera is connected"));
    virtualDevice().plug(true);
  }
}

TEST_F(DeviceFaults, AnotherCamerasUnpluggingIsNotItsOwn) {
  virtualDevice(1).plug(true);
  DeviceSettings settings;
  settings.device = "virtual/0";
  Device device(settings, keeper_.sink());
  virtualDevice(1).plug(false);
  ASSERT_TRUE(keeper_.waitFor(3));
  EXPECT_TRUE(device.isConnected());
}

TEST_F(DeviceFaults, TwoDevicesStreamAtOnce) {
  virtualDevice(1).plug(true);
  DeviceSettings settings;
  settings.device = "virtual/1";
  FrameKeeper other;
  Device first({}, keeper_.sink());
  Device second(settings, other.sink());
  EXPECT_TRUE(keeper_.waitFor(5));
  EXPECT_TRUE(other.waitFor(5));
}

}  // namespace
}  // namespace pf::openni2

// SPDX-License-Identifier: BSD-3-Clause
#include "device_fixture.hpp"

namespace pf::openni2 {
namespace {

class OpenDevice : public DeviceTest {};

TEST_F(OpenDevice, DeliversEveryPixelAsItWasServed) {
  FrameKeeper keeper;
  {
    Device device({}, keeper.sink());
    ASSERT_TRUE(keeper.waitFor(12));
  }
  for (const auto kind : {StreamKind::color, StreamKind::depth}) {
    int last = 0;
    for (const auto& frame : keeper.frames(kind)) {
      EXPECT_EQ(frame.width, 640);
      EXPECT_EQ(frame.height, 480);
      EXPECT_EQ(frame.pixels, servedPixels(kind, frame, frame.index)) << nameOf(kind);
      EXPECT_EQ(frame.device_time_us, virtualTimeUs(frame.index, 30));
      EXPECT_GT(frame.index, last);
      last = frame.index;
    }
  }
}

TEST_F(OpenDevice, NoFrameComesAfterItIsClosed) {
  FrameKeeper keeper;
  {
    Device device({}, keeper.sink());
    ASSERT_TRUE(keeper.waitFor(3));
  }
  const auto frames = keeper.count(StreamKind::color) + keeper.count(StreamKind::depth);
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  EXPECT_EQ(keeper.count(StreamKind::color) + keeper.count(StreamKind::depth), frames);
}

TEST_F(OpenDevice, RequestsRegistrationSyncAndNoMirroring) {
  FrameKeeper keeper;
  const Device device({}, keeper.sink());
  EXPECT_EQ(virtualDevice().registration, 1);
  EXPECT_EQ(virtualDevice().mirroring[0], 0);
  EXPECT_EQ(virtualDevice().mirroring[1], 0);
  EXPECT_TRUE(eventually([] { return virtualDevice().sync == 1; }));
  EXPECT_TRUE(device.isRegistered());
  EXPECT_TRUE(device.isSynchronised());
  EXPECT_TRUE(device.warnings().empty());
}

TEST_F(OpenDevice, RequestsNeitherRegistrationNorSyncWhereDisabled) {
  DeviceSettings settings;
  settings.depth_registration = settings.frame_sync = false;
  FrameKeeper keeper;
  const Device device(settings, keeper.sink());
  ASSERT_TRUE(keeper.waitFor(1));
  EXPECT_EQ(virtualDevice().registration, 0);
  EXPECT_NE(virtualDevice().sync, 1);
  EXPECT_FALSE(device.isRegistered());
  EXPECT_FALSE(device.isSynchronised());
}

TEST_F(OpenDevice, ReportsItsIdentityAndItsStreams) {
  FrameKeeper keeper;
  const Device device({}, keeper.sink());
  EXPECT_EQ(device.identity().uri, "virtual/0");
  EXPECT_EQ(device.identity().vendor, "posefusion");
  EXPECT_EQ(device.identity().name, "virtual camera");
  EXPECT_EQ(device.identity().serial, "V0001");
  EXPECT_FALSE(device.identity().is_file);
  for (const auto kind : {StreamKind::color, StreamKind::depth}) {
    const StreamInfo info = device.stream(kind);
    EXPECT_EQ(info.mode, StreamMode({640, 480, 30}));
    EXPECT_NEAR(320 / std::tan(info.horizontal_fov_rad / 2), 525, 1e-3);
    EXPECT_NEAR(240 / std::tan(info.vertical_fov_rad / 2), 525, 1e-3);
  }
}

TEST_F(OpenDevice, IsFoundByUriNumberAndSerial) {
  virtualDevice(1).plug(true);
  for (const char* name : {"virtual/1", "#2", "V0002"}) {
    DeviceSettings settings;
    settings.device = name;
    FrameKeeper keeper;
    const Device device(settings, keeper.sink());
    EXPECT_EQ(device.identity().serial, "V0002") << name;
  }
}

TEST_F(OpenDevice, StreamsInAnotherMode) {
  DeviceSettings settings;
  settings.color_mode = settings.depth_mode = {320, 240, 60};
  FrameKeeper keeper;
  {
    const Device device(settings, keeper.sink());
    EXPECT_EQ(device.stream(StreamKind::color).mode, settings.color_mode);
    ASSERT_TRUE(keeper.waitFor(10));
  }
  for (const auto kind : {StreamKind::color, StreamKind::depth}) {
    const auto frame = keeper.frames(kind).back();
    EXPECT_EQ(frame.width, 320);
    EXPECT_EQ(frame.device_time_us, virtualTimeUs(frame.index, 60));
    EXPECT_EQ(frame.pixels, servedPixels(kind, frame, frame.index));
  }
}

TEST_F(OpenDevice, ReportsTheTemperatureWhereThereIsOne) {
  FrameKeeper keeper;
  const Device device({}, keeper.sink());
  EXPECT_FALSE(device.temperature_c());
  virtualDevice().temperature_c100 = 3725;
  ASSERT_TRUE(device.temperature_c());
  EXPECT_DOUBLE_EQ(*device.temperature_c(), 37.25);
}

TEST_F(OpenDevice, SetsTheExposure) {
  FrameKeeper keeper;
  Device device({}, keeper.sink());
  ExposureSettings settings;
  EXPECT_TRUE(device.apply(settings).empty());
  EXPECT_EQ(virtualDevice().auto_exposure, 1);
  EXPECT_EQ(virtualDevice().auto_white_balance, 1);
  EXPECT_EQ(virtualDevice().exposure, -1);
  settings.auto_exposure = settings.auto_white_balance = false;
  settings.exposure = 17;
  settings.gain = 300;
  EXPECT_TRUE(device.apply(settings).empty());
  EXPECT_EQ(virtualDevice().auto_exposure, 0);
  EXPECT_EQ(virtualDevice().auto_white_balance, 0);
  EXPECT_EQ(virtualDevice().exposure, 17);
  EXPECT_EQ(virtualDevice().gain, 300);
  EXPECT_EQ(device.exposure().value_or(-1), 17);
  settings.max_exposure = 11;
  EXPECT_TRUE(device.apply(settings).empty());
  EXPECT_EQ(virtualDevice().exposure, 11);
}

TEST_F(OpenDevice, HoldsTheAutoExposureAtItsLimit) {
  FrameKeeper keeper;
  Device device({}, keeper.sink());
  ExposureSettings settings;
  settings.max_exposure = 25;
  EXPECT_TRUE(device.apply(settings).empty());
  EXPECT_FALSE(device.limitExposure()) << "20 is below the limit";
  EXPECT_EQ(virtualDevice().auto_exposure, 1);
  virtualDevice().automatic_exposure = 40;
  EXPECT_TRUE(device.limitExposure());
  EXPECT_EQ(virtualDevice().auto_exposure, 0);
  EXPECT_EQ(virtualDevice().exposure, 25);
  EXPECT_FALSE(device.limitExposure()) << "once";
}

TEST_F(OpenDevice, ReportsThatItHasNoExposureSettings) {
  virtualDevice().has_camera_settings = false;
  FrameKeeper keeper;
  Device device({}, keeper.sink());
  const auto failures = device.apply({});
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_TRUE(contains(failures[0], "no settings of exposure"));
  EXPECT_FALSE(device.exposure());
}

}  // namespace
}  // namespace pf::openni2

// SPDX-License-Identifier: BSD-3-Clause
// Cameras that go and come, settings that are no good, and a driver that is unloaded.
#include <dynamic_reconfigure/Reconfigure.h>

#include "nodelet_fixture.hpp"

namespace pf::openni2 {
namespace {

TEST_F(DriverNodelet, ComesBackAfterTheCameraWasUnplugged) {
  load();
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(streams(3));
    EXPECT_TRUE(diagnosed(DiagnosticStatus::OK, "streaming"));
    EXPECT_EQ(diagnosticValue("serial number"), "V0001");
    virtualDevice().plug(false);
    EXPECT_TRUE(diagnosed(DiagnosticStatus::ERROR, "no camera is connected"));
    virtualDevice().plug(true);
  }
  ASSERT_TRUE(streams(3));
}

TEST_F(DriverNodelet, WaitsForACameraThatIsNotThereYet) {
  virtualDevice().plug(false);
  load();
  EXPECT_TRUE(diagnosed(DiagnosticStatus::ERROR, "looked for any camera"));
  virtualDevice().plug(true);
  EXPECT_TRUE(streams(3));
}

TEST_F(DriverNodelet, OpensASilentCameraAgain) {
  set("stall_timeout_s", 0.5);
  load();
  ASSERT_TRUE(streams(3));
  const int opened = virtualDevice().opened;
  virtualDevice().stalled = true;
  EXPECT_TRUE(eventually([&] { return virtualDevice().opened > opened; }));
  virtualDevice().stalled = false;
  EXPECT_TRUE(streams(3));
}

TEST_F(DriverNodelet, ListsItsModes) {
  set("color_mode", "800x600@30");
  load();
  EXPECT_TRUE(diagnosed(DiagnosticStatus::ERROR, "640x480@30 RGB"));
}

TEST_F(DriverNodelet, StaysIdleWithAnImpossibleParameterAndLeavesTheManagerAlive) {
  set("color_mode", "VGA");
  load();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(color_.size(), 0u);
  EXPECT_TRUE(ros::ok());
  unload();
  set("color_mode", "640x480@30");
  load();
  EXPECT_TRUE(streams(2));
}

// The answer of a service may come before its callback has returned: unloading then leaves the last
// reference with the thread of the callback. Without the QueueKeeper this crashes now and then.
TEST_F(DriverNodelet, GoesWhileAServiceIsCalled) {
  for (int i = 0; i < 10; ++i) {
    load();
    std::atomic<bool> ends{false};
    std::thread caller([&] {
      dynamic_reconfigure::Reconfigure call;
      while (!ends) ros::service::call(std::string(kName) + "/set_parameters", call);
    });
    ASSERT_TRUE(streams(1));
    unload();
    ends = true;
    caller.join();
  }
}

TEST_F(DriverNodelet, GoesWhileItStreamsAndWhileItRecords) {
  for (int i = 0; i < 10; ++i) {
    load();
    if (i % 2 == 0) {
      ASSERT_TRUE(streams(1));
      EXPECT_TRUE(record(true).success);
    }
    unload();
    EXPECT_EQ(virtualDevice().running_streams, 0);
  }
}

}  // namespace
}  // namespace pf::openni2

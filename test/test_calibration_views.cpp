// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/calibration_views.hpp"

#include <gtest/gtest.h>

#include "posefusion/core/error.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "simulated_sequence.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

TEST(CalibrationViews, AreOfTheCameraThatTheMapWasMadeWith) {
  const TemporaryFolder folder;
  Config config;
  config.frame.shrink = 1;
  config.frame.max_depth_m = 3.5;
  config.sensor.kind = "time_of_flight";
  Mapper mapper(config);
  const auto& room = exactBox<10>();
  for (int i = 0; i < 10; ++i) mapper.process({room.frame(i).frame, {}, {}});
  {
    MapRecording recording(folder / "map.pfdb", MapWriter::Mode::create, toYaml(config), mapper);
    ASSERT_EQ(recording.update(room.frame(0).frame.camera, mapper), "");
    ASSERT_TRUE(recording.finish(mapper));
  }

  const CalibrationViews all = readCalibrationViews(folder / "map.pfdb");
  ASSERT_EQ(all.views.size(), mapper.keyframeViews().size());
  ASSERT_FALSE(all.views.empty());
  EXPECT_FALSE(all.corrected_by);
  for (const CalibrationView& view : all.views) {
    EXPECT_EQ(view.sensor.kind, DepthSensorKind::time_of_flight);
    EXPECT_EQ(view.sensor.max_depth_m, 3.5);
    EXPECT_EQ(view.depth_mm.cols, view.camera.width);
  }
}

TEST(CalibrationViews, OfWhatIsNoMapAreRefused) {
  EXPECT_THROW(readCalibrationViews("/nowhere/map.pfdb"), InputError);
}

}  // namespace
}  // namespace pf

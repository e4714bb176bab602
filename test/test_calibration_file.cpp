// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/calibration_file.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "calibration_room.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/files.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

DepthCalibration example() {
  return {"a \"quoted\": name #1",
          test::roomCamera(640),
          test::roomField(),
          123,
          1500,
          7.25,
          5.5,
          0.0004};
}

std::string errorOfFile(const std::string& path) {
  return errorOf([&] { loadCalibration(path); });
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(CalibrationFile, comesBackAsItWasWritten) {
  const TemporaryFolder folder;
  const std::string path = folder / "calibration.yaml";
  const DepthCalibration before = example();
  saveCalibration(path, before);
  const DepthCalibration after = loadCalibration(path);
  EXPECT_EQ(after.name, before.name);
  EXPECT_EQ(after.camera, before.camera);
  EXPECT_EQ(after.keyframes, before.keyframes);
  EXPECT_EQ(after.pairs, before.pairs);
  EXPECT_EQ(after.before_mm, before.before_mm);
  EXPECT_EQ(after.after_mm, before.after_mm);
  EXPECT_LT(compare(after.field, before.field).rms_difference, 1e-11);
  saveCalibration(folder / "again.yaml", after);
  EXPECT_EQ(readFile(path), readFile(folder / "again.yaml")) << "the same bytes";
}

TEST(CalibrationFile, refusesWhatIsWrongAndNamesIt) {
  const TemporaryFolder folder;
  const std::string path = folder / "calibration.yaml";
  saveCalibration(path, example());
  const std::string good = readFile(path);
  const std::vector<std::pair<std::string, std::string>> hostile = {
      {"columns: 12", "columns: 13"},
      {"columns: 12", "columns: 3"},
      {"columns: 12", "columns: 1000000"},
      {"rows: 9", "rows: nine"},
      {"rows: 9\n", ""},
      {"nodes_per_m: [", "nodes_per_m: [nan, "},
      {"nodes_per_m: [\n  ", "nodes_per_m: [\n  9"},
      {"model: inverse_depth_spline", "model: guess"},
      {"model: inverse_depth_spline\n", ""},
      {"width: 640", "width: 0"},
      {"fx: 524.8", "fx: .inf"},
      {"fx: 524.8, ", ""},
      {"keyframes: 123", "keyframes: -1"},
      {"pairs: 1500", "unknown: 1"},
      {"rows: 9", "rows: 9\nrows: 9"},
      {"]", ""},
  };
  for (const auto& [what, by] : hostile) {
    folder.write("calibration.yaml", replaced(good, what, by));
    const std::string error = errorOfFile(path);
    EXPECT_EQ(error.rfind(path, 0), 0U) << "'" << by << "': " << error;
  }
  for (const std::string text : {"", "[1, 2]", "\x01\x02", "model: [", "a: &a [*a, *a]"}) {
    folder.write("calibration.yaml", text);
    EXPECT_EQ(errorOfFile(path).rfind(path, 0), 0U) << text;
  }
  EXPECT_NE(errorOfFile(folder / "missing.yaml"), "");
  EXPECT_NE(errorOfFile(folder.str()), "");
}

TEST(CalibrationFile, holdsForAllSizesOfItsCamera) {
  const DepthCalibration calibration = example();
  EXPECT_EQ(misfit(calibration, calibration.camera), "");
  EXPECT_EQ(misfit(calibration, calibration.camera.shrunk(2)), "");
  PinholeCamera better = calibration.camera;
  better.fx *= 1.002;  // calibrated once more
  better.cx += 1.5;
  EXPECT_EQ(misfit(calibration, better), "");
  PinholeCamera other = calibration.camera;
  other.fx *= 1.3;
  EXPECT_NE(misfit(calibration, other).find("640 x 480"), std::string::npos);
}

}  // namespace
}  // namespace pf

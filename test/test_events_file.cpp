// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "posefusion/io/events_file.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

TEST(EventsFile, TakesBlurredFramesAndFallsInOrder) {
  TemporaryFolder folder;
  const auto events = loadEvents(folder.write("events.json", R"({"scenario": "x", "events": [
    {"kind": "fall", "start": "9.5", "end": "12.0"},
    {"kind": "blurred", "start": "2.033333", "end": "2.033333", "smear_px": 5.4},
    {"kind": "bump", "start": "1.0", "end": "1.1"},
    {"kind": "blurred", "start": "1.500000", "end": "1.500000"},
    {"kind": "fall", "start": "4.0", "end": "5.0"}]})"));
  EXPECT_EQ(events.blurred_ns, (std::vector<std::int64_t>{1'500'000'000, 2'033'333'000}));
  EXPECT_EQ(events.fall_starts_ns, (std::vector<std::int64_t>{4'000'000'000, 9'500'000'000}));
  EXPECT_EQ(events.fall_ends_ns, (std::vector<std::int64_t>{5'000'000'000, 12'000'000'000}));
}

TEST(EventsFile, WrongInputIsAnErrorThatNamesTheFile) {
  TemporaryFolder folder;
  const auto said = [&](const std::string& text) {
    return errorOf([&] { loadEvents(folder.write("e.json", text)); });
  };
  EXPECT_NE(said("{").find("e.json: "), std::string::npos);
  EXPECT_NE(said("{}").find("events"), std::string::npos);
  EXPECT_NE(said(R"({"events": [{"kind": "fall"}]})").find("start"), std::string::npos);
  EXPECT_NE(said(R"({"events": [{"kind": "fall", "start": "1.0"}]})").find("end"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { loadEvents(folder / "none.json"); }).find("none.json"),
            std::string::npos);
}

}  // namespace
}  // namespace pf

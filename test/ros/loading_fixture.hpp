// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <posefusion/LoadMap.h>
#include <posefusion/SetMode.h>

#include <filesystem>
#include <optional>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/saved_map_file.hpp"

namespace posefusion_ros {

using posefusion::LoadMap;
using posefusion::SetMode;

/// A chain, and a map of the empty room that it may begin in.
class ChainLoading : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new pf::TemporaryFolder;
    pf::Config config;
    config.frame.shrink = 1;
    pf::Mapper mapper(config);
    for (int i = 0; i < 20; ++i) mapper.process({emptyRoom().frame(i).frame, {}, {}});
    pf::MapRecording recording(*made_ / "map.pfdb", pf::MapWriter::Mode::create, "", mapper);
    recording.update(emptyRoom().frame(0).frame.camera, mapper);
    recording.finish(mapper);
  }
  static void TearDownTestSuite() { delete made_; }

  void SetUp() override {
    std::filesystem::copy(*made_ / "map.pfdb", folder / "map.pfdb");
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    chain.emplace(std::string("loading_") + test->name());
    chain->set("frame/shrink", 1);
    chain->set("output", folder / "out");
  }

  std::string map() const { return folder / "map.pfdb"; }

  pf::RgbdFrame frame(int index) const {
    pf::RgbdFrame frame = emptyRoom().frame(index % 40).frame;
    frame.stamp_ns = 1'000'000'000LL + index * 33'333'333LL + later_ns;
    return frame;
  }
  TrackingStatusMsg process(int index) { return chain->process(toMessages(frame(index))); }

  /// Shows frames until the camera is found; the next one to show, or -1.
  int find(int index) {
    for (int end = index + 39; index < end; ++index) {
      if (process(index).state == TrackingStatusMsg::TRACKING) return index + 1;
    }
    return -1;
  }

  LoadMap::Response loadMap(const std::string& file) {
    return chain->call<LoadMap>("load_map", &LoadMap::Request::file, file);
  }
  SetMode::Response setMode(const std::string& mode) {
    return chain->call<SetMode>("set_mode", &SetMode::Request::mode, mode);
  }

  const pf::TemporaryFolder folder;
  std::optional<Chain> chain;
  std::int64_t later_ns = 0;

 private:
  static inline pf::TemporaryFolder* made_ = nullptr;
};

}  // namespace posefusion_ros

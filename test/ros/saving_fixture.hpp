// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace posefusion_ros {

/// A chain that saves, and a camera in an empty room.
class ChainSaving : public testing::Test {
 protected:
  void load(const std::string& space, const std::string& output) {
    chain.emplace(space);
    chain->set("output", output);
    ASSERT_TRUE(chain->load());
  }

  /// Sends a frame of the room and waits for its status.
  TrackingStatusMsg process(int index, std::int64_t later_s = 0) {
    pf::RgbdFrame frame = emptyRoom().frame(index).frame;
    frame.stamp_ns += later_s * 1000000000L;
    return chain->process(toMessages(frame));
  }

  /// The folders of maps in order, besides the link to the latest: those that grew, or those that
  /// were saved on request.
  std::vector<std::string> folders(const std::string& output, bool on_request) const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder / output)) {
      const std::string path = entry.path().string();
      const bool is_saved = path.find("_saved") != std::string::npos;
      if (!entry.is_symlink() && is_saved == on_request) found.push_back(path);
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  std::vector<std::string> runs() const { return folders("out", false); }
  std::vector<std::string> saves() const { return folders("out", true); }

  static std::size_t posesOf(const std::string& file) { return pf::loadTrajectory(file).size(); }

  const pf::TemporaryFolder folder;
  std::optional<Chain> chain;
};

}  // namespace posefusion_ros

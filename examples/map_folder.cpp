// SPDX-License-Identifier: BSD-3-Clause
// A recording in, trajectory and map out: map_folder TUM_FOLDER [OUTPUT_FOLDER]
#include <exception>
#include <iostream>
#include <string>

#include "posefusion/io/frame_source.hpp"
#include "posefusion/run/slam.hpp"

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    std::cerr << "usage: map_folder TUM_FOLDER [OUTPUT_FOLDER]\n";
    return 2;
  }
  const std::string output = argc == 3 ? argv[2] : ".";
  try {
    const auto recording = pf::openTumFolder(argv[1]);
    pf::Config config;
    pf::applyMode(config, "pfh");                        // with removal of people and blur gate
    pf::applyAssignment(config, "frame.max_depth_m=5");  // any setting of config/posefusion.yaml
    pf::Slam slam(config, *recording);
    slam.process(*recording, {});
    std::cout << slam.finish() << "\n";
    slam.saveTrajectory(output + "/trajectory.txt");
    std::cout << slam.trajectory().size() << " poses, " << slam.saveMap(output + "/map.ply")
              << " surfels in " << output << "\n";
  } catch (const std::exception& error) {
    std::cerr << "map_folder: " << error.what() << "\n";
    return 1;
  }
  return 0;
}

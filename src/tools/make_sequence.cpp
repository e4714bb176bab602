// SPDX-License-Identifier: BSD-3-Clause
// posefusion_make_sequence: writes the code-made sequence as a TUM folder with its truth.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "posefusion/core/error.hpp"
#include "posefusion/io/tum_writer.hpp"
#include "synthetic/sequence.hpp"

namespace {

using namespace pf;

void write(const SyntheticSequence& sequence, const std::string& folder) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  TumWriter writer(folder, sequence.camera());
  for (int i = 0; i < sequence.frameCount(); ++i) {
    const SyntheticFrame frame = sequence.frame(i);
    writer.add(frame.frame);
    writer.addTruth({frame.frame.stamp_ns, frame.T_map_camera});
    writer.addMask(frame.frame.stamp_ns, frame.mask);
    writer.addPeople(frame.people);
    if (terminal) std::fprintf(stderr, "\rframe %d of %d", i + 1, sequence.frameCount());
  }
  if (terminal) std::fprintf(stderr, "\n");
  writer.finish();
}

}  // namespace

int main(int argc, char** argv) {
  SyntheticOptions options;
  bool no_figure = false;
  std::string folder;
  CLI::App app{
      "Makes a short RGB-D sequence of a furnished room, as a TUM folder with true poses, masks\n"
      "of the person and the person's joints. The same seed gives the same files."};
  app.set_version_flag("--version", POSEFUSION_VERSION);
  app.add_option("output_dir", folder, "new folder")->required();
  app.add_option("--frames", options.frames, "number of frames, at 30 Hz")->capture_default_str();
  app.add_option("--seed", options.seed, "camera path and textures")->capture_default_str();
  app.add_option("--noise", options.noise, "true or false: noise of the sensor")
      ->capture_default_str();
  app.add_flag("--no-figure", no_figure, "an empty room: nobody walks through");
  CLI11_PARSE(app, argc, argv);
  options.figure = !no_figure;
  try {
    const SyntheticSequence sequence(options);
    write(sequence, folder);
    std::cout << sequence.frameCount() << " frames in " << folder << "\n";
    return 0;
  } catch (const InputError& error) {
    std::cerr << "posefusion_make_sequence: " << error.what() << "\n";
    return 1;
  }
}

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// One body part that the network draws a heat map for.
struct NetworkPart {
  std::string name;
  int channel = 0;  ///< of the heat map in the network's output
  int joint = -1;   ///< index of the COCO-18 joint, -1: the part only links others
};

/// One limb: a part affinity field (PAF) between two parts (indices into the part list).
struct NetworkLimb {
  int from = 0;
  int to = 0;
  int channel_x = 0;
  int channel_y = 0;
};

/// How to feed a pose network and to read its output: the YAML file beside the model.
struct ModelSettings {
  std::string prototxt;          ///< Caffe only: file name beside the weights
  int input_height_px = 320;     ///< the width follows from the image's aspect ratio
  int input_multiple_px = 16;    ///< height and width are multiples of this
  double scale = 1.0;            ///< network value = (pixel - mean) * scale
  std::array<double, 3> mean{};  ///< in the network's channel order, grey levels
  bool bgr = true;               ///< the network's channel order is B G R, otherwise R G B
  int stride = 8;                ///< input pixels for one output pixel
  std::vector<NetworkPart> parts;
  std::vector<NetworkLimb> limbs;  ///< in the order of assembly
};

/// Reads a settings file. Throws InputError naming the file and the entry.
ModelSettings loadModelSettings(const std::string& path);

/// The settings file of a model: `<stem>.yaml` beside it, else in config/models of the package
/// (environment POSEFUSION_CONFIG_DIR, source tree, installation: the first that has it). Throws
/// InputError naming the places searched.
std::string findModelSettings(const std::string& model_path);

/// The model used where the configuration names none: posefusion/models in the user's data folder
/// ($XDG_DATA_HOME or ~/.local/share).
std::string defaultModelPath();

}  // namespace pf

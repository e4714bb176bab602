// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/person_model.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/dnn.hpp>

#include "package_folders.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/pose/network_layers.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

/// Name and shape of an output: channels x height x width.
struct Output {
  const char* name;
  int channels, height, width;
};
constexpr std::array<Output, 3> kOutputs{{{"mask", 1, kMaskHeight, kMaskWidth},
                                          {"joints", kJointCount, kMapHeight, kMapWidth},
                                          {"centre", 3, kMapHeight, kMapWidth}}};

std::string shapeOf(const cv::Mat& blob) {
  std::string text;
  for (int i = 0; i < blob.dims; ++i) text += (i > 0 ? "x" : "") + std::to_string(blob.size[i]);
  return text;
}

cv::Mat planeOf(cv::Mat& blob, int channel) {
  return {blob.size[2], blob.size[3], CV_32FC1, blob.ptr<float>(0, channel)};
}

}  // namespace

struct PersonModel::Backend {
  cv::dnn::Net net;
  std::vector<cv::String> names;
  cv::Mat input;
  std::vector<cv::Mat> outputs;
};

PersonModel::PersonModel(const std::string& path)
    : path_(path), backend_(std::make_unique<Backend>()) {
  const std::string where = "pose.embedded_model: " + path_;
  if (!fs::is_regular_file(path_) || !std::ifstream(path_)) {
    throw InputError(where + " cannot be read; the package has it as models/person.onnx");
  }
  try {
    backend_->net = readWithFastLayers([this] { return cv::dnn::readNetFromONNX(path_); });
  } catch (const cv::Exception& error) {
    throw InputError(where + " is no network that OpenCV can read (" + error.err + ")");
  }
  backend_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  backend_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  for (const Output& output : kOutputs) backend_->names.emplace_back(output.name);
  infer(cv::Mat::zeros(kDepthInputHeight, kDepthInputWidth, CV_32FC1));
}

PersonModel::~PersonModel() = default;

PersonMaps PersonModel::infer(const cv::Mat& small_m) {
  const std::string where = "pose.embedded_model: " + path_;
  depthInput(small_m, backend_->input);
  try {
    backend_->net.setInput(backend_->input, "depth");
    backend_->net.forward(backend_->outputs, backend_->names);
  } catch (const cv::Exception& error) {
    throw InputError(where + " cannot be run on a depth of 1x3x120x160 for the outputs mask, " +
                     "joints and centre (" + error.err + ")");
  }
  for (std::size_t i = 0; i < kOutputs.size(); ++i) {
    const Output& expected = kOutputs[i];
    const cv::Mat& found = backend_->outputs[i];
    const bool fits = found.dims == 4 && found.size[0] == 1 && found.size[1] == expected.channels &&
                      found.size[2] == expected.height && found.size[3] == expected.width &&
                      found.type() == CV_32F;
    if (fits) continue;
    throw InputError(where + " gives " + expected.name + " as " + shapeOf(found) + ", expected 1x" +
                     std::to_string(expected.channels) + "x" + std::to_string(expected.height) +
                     "x" + std::to_string(expected.width));
  }
  PersonMaps maps;
  maps.mask = planeOf(backend_->outputs[0], 0);
  for (int j = 0; j < kJointCount; ++j) {
    maps.joints[static_cast<std::size_t>(j)] = planeOf(backend_->outputs[1], j);
  }
  maps.centre = planeOf(backend_->outputs[2], 0);
  maps.offset_x = planeOf(backend_->outputs[2], 1);
  maps.offset_y = planeOf(backend_->outputs[2], 2);
  return maps;
}

std::string packagedPersonModel() {
  fs::path file;
  for (const fs::path& folder : packageFolders("models")) {
    file = folder / "person.onnx";
    if (fs::exists(file)) break;
  }
  return file.string();
}

}  // namespace pf

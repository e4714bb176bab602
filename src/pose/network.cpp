// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/network.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/dnn.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/pose/network_layers.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAdvice =
    "; fetch one with scripts/get_models, name another with pose.model, or choose pose.detector "
    "embedded, recorded or none";

void requireReadable(const std::string& path) {
  if (!fs::is_regular_file(path) || !std::ifstream(path)) {
    throw InputError("pose.model: cannot read " + path + kAdvice);
  }
}

cv::dnn::Net readNet(const std::string& path, const ModelSettings& settings) {
  const fs::path model(path);
  const std::string ending = model.extension().string();
  if (ending == ".pb") return cv::dnn::readNetFromTensorflow(path);
  if (ending == ".onnx") return cv::dnn::readNetFromONNX(path);
  fs::path prototxt = model;
  prototxt.replace_extension(".prototxt");
  if (!fs::exists(prototxt) && !settings.prototxt.empty()) {
    prototxt = model.parent_path() / settings.prototxt;
  }
  requireReadable(prototxt.string());
  return cv::dnn::readNetFromCaffe(prototxt.string(), path);
}

void requireKnownEnding(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  if (ending != ".pb" && ending != ".onnx" && ending != ".caffemodel") {
    throw InputError("pose.model: " + path + " ends in '" + ending +
                     "', expected .pb (TensorFlow), .caffemodel (Caffe) or .onnx");
  }
}

}  // namespace

struct PoseNetwork::Backend {
  cv::dnn::Net net;
  cv::Size size;  // of the input that the net has seen
  cv::Mat input;
  cv::Mat output;
};

PoseNetwork::PoseNetwork(const std::string& model_path, int input_height_px)
    : model_path_(model_path), backend_(std::make_unique<Backend>()) {
  requireKnownEnding(model_path_);
  requireReadable(model_path_);
  settings_ = loadModelSettings(findModelSettings(model_path_));
  if (input_height_px > 0) settings_.input_height_px = input_height_px;
  read();
}

void PoseNetwork::read() {
  try {
    backend_->net = readWithFastLayers([this] { return readNet(model_path_, settings_); });
  } catch (const cv::Exception& error) {
    throw InputError("pose.model: " + model_path_ + " is no network that OpenCV can read (" +
                     error.err + ")" + kAdvice);
  }
  backend_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  backend_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  backend_->size = cv::Size();
}

PoseNetwork::~PoseNetwork() = default;

cv::Size PoseNetwork::inputSize(const cv::Size& image) const {
  const int step = settings_.input_multiple_px;
  const auto rounded = [step](double pixels) {
    return std::max(step, static_cast<int>(std::lround(pixels / step)) * step);
  };
  const double width = static_cast<double>(settings_.input_height_px) * image.width / image.height;
  return {rounded(width), rounded(settings_.input_height_px)};
}

PoseMaps PoseNetwork::infer(const cv::Mat& color) {
  const cv::Scalar mean(settings_.mean[0], settings_.mean[1], settings_.mean[2]);
  const cv::Size size = inputSize(color.size());
  // Its layers are fused (OpenCV's default): after that OpenCV 4.6 computes nonsense for any other
  // shape of the input.
  if (!backend_->size.empty() && size != backend_->size) read();
  backend_->size = size;
  try {
    cv::dnn::blobFromImage(color, backend_->input, settings_.scale, size, mean, settings_.bgr,
                           false, CV_32F);
    backend_->net.setInput(backend_->input);
    backend_->output = backend_->net.forward();
  } catch (const cv::Exception& error) {
    throw InputError("pose.model: " + model_path_ + " cannot be run (" + error.err + ")" + kAdvice);
  }
  checkChannels(backend_->output);
  return {backend_->output};
}

void PoseNetwork::checkChannels(const cv::Mat& blob) const {
  int needed = 0;
  for (const NetworkPart& part : settings_.parts) needed = std::max(needed, part.channel + 1);
  for (const NetworkLimb& limb : settings_.limbs) {
    needed = std::max({needed, limb.channel_x + 1, limb.channel_y + 1});
  }
  if (blob.dims == 4 && blob.size[1] >= needed) return;
  throw InputError("pose.model: " + model_path_ + " gives " +
                   std::to_string(blob.dims == 4 ? blob.size[1] : 0) +
                   " channels, its settings expect at least " + std::to_string(needed));
}

}  // namespace pf

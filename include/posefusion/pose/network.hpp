// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "posefusion/pose/model_settings.hpp"

namespace pf {

/// The output of a pose network: one CV_32FC1 plane per channel (heat maps of the parts and part
/// affinity fields), at 1/stride of the network's input.
struct PoseMaps {
  cv::Mat blob;  ///< CV_32F, 1 x channels x rows x cols

  int channels() const { return blob.size[1]; }
  cv::Size size() const { return {blob.size[3], blob.size[2]}; }
  /// View of one channel; shares the blob's memory.
  cv::Mat plane(int channel) const {
    return {blob.size[2], blob.size[3], CV_32FC1, const_cast<float*>(blob.ptr<float>(0, channel))};
  }
};

/// A pose network run by OpenCV on the CPU: Caffe (.caffemodel and .prototxt), TensorFlow (.pb) or
/// ONNX by file ending. One thread at a time; the result does not depend on OpenCV's thread count.
class PoseNetwork {
 public:
  /// `input_height_px` overrides the settings' input height unless 0. Throws InputError naming the
  /// file, and how to get one, where the model or its settings are missing or unreadable.
  explicit PoseNetwork(const std::string& model_path, int input_height_px = 0);
  ~PoseNetwork();

  /// `color`: CV_8UC3 R G B of any size. The maps are valid until the next call.
  PoseMaps infer(const cv::Mat& color);

  /// The network's input for an image: the height of the settings, the width by the aspect ratio.
  cv::Size inputSize(const cv::Size& image) const;

  const ModelSettings& settings() const { return settings_; }

 private:
  void read();
  void checkChannels(const cv::Mat& blob) const;

  std::string model_path_;
  ModelSettings settings_;
  struct Backend;
  std::unique_ptr<Backend> backend_;
};

}  // namespace pf

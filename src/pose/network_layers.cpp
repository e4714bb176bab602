// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/network_layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <opencv2/dnn/all_layers.hpp>

#include "convolution_layers.hpp"
#include "pointwise_kernel.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

namespace dnn = cv::dnn;

constexpr int kLanes = 16;
constexpr std::size_t kPlanesAtOnce = 2;

/// Sums of (x - origin) and of its square, lane by lane: the order of the additions is fixed.
POSEFUSION_SIMD_CLONES
void addUp(const float* x, int count, float origin, float* sum, float* square) {
  for (int i = 0; i + kLanes <= count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const float d = x[i + lane] - origin;
      sum[lane] += d;
      square[lane] += d * d;
    }
  }
}

/// y = (x - mean) / sqrt(variance + eps), each channel by itself, then scale, shift, activation.
class ChannelNormalization : public dnn::Layer {
 public:
  explicit ChannelNormalization(const dnn::LayerParams& params) {
    setParamsFrom(params);
    eps_ = params.get<double>("eps", 1e-9);
  }

  bool getMemoryShapes(const std::vector<dnn::MatShape>& inputs, int,
                       std::vector<dnn::MatShape>& outputs,
                       std::vector<dnn::MatShape>&) const override {
    outputs.assign(1, inputs.at(0));
    return true;  // the output may take the input's memory
  }

  bool tryFuse(cv::Ptr<dnn::Layer>& next) override {
    if (!scale_.empty() || !shift_.empty() || activation_) return false;
    next->getScaleShift(scale_, shift_);
    return !scale_.empty() || !shift_.empty();
  }

  bool setActivation(const cv::Ptr<dnn::ActivationLayer>& activation) override {
    activation_ = activation;
    return !activation_.empty();
  }

  void unsetAttached() override {
    activation_.release();
    scale_.release();
    shift_.release();
  }

  void forward(cv::InputArrayOfArrays inputs, cv::OutputArrayOfArrays outputs,
               cv::OutputArrayOfArrays) override {
    std::vector<cv::Mat> in, out;
    inputs.getMatVector(in);
    outputs.getMatVector(out);
    const int channels = in[0].size[1];
    const auto planes = static_cast<std::size_t>(in[0].size[0] * channels);
    const int count = static_cast<int>(in[0].total() / planes);
    parallelFor(planes, kPlanesAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t plane = begin; plane < end; ++plane) {
        const std::size_t offset = plane * static_cast<std::size_t>(count);
        normalize(in[0].ptr<float>() + offset, count, static_cast<int>(plane) % channels,
                  out[0].ptr<float>() + offset);
      }
    });
  }

 private:
  void normalize(const float* x, int count, int channel, float* y) const {
    // Sums about a value of the channel itself lose no digits where the mean is large.
    const float origin = x[0];
    std::array<float, kLanes> sums{}, squares{};
    addUp(x, count, origin, sums.data(), squares.data());
    double sum = 0.0, square = 0.0;
    for (int lane = 0; lane < kLanes; ++lane) {
      sum += sums[lane];
      square += squares[lane];
    }
    for (int i = count - count % kLanes; i < count; ++i) {
      const double d = x[i] - origin;
      sum += d;
      square += d * d;
    }
    const double mean = sum / count;
    const double variance = std::max(0.0, square / count - mean * mean);
    double factor = 1.0 / std::sqrt(variance + eps_);
    if (!scale_.empty()) factor *= scale_.at<float>(channel);
    double offset = -(mean + origin) * factor;
    if (!shift_.empty()) offset += shift_.at<float>(channel);
    kernel::applyLine(x, count, static_cast<float>(factor), static_cast<float>(offset), y);
    if (activation_) {
      activation_->forwardSlice(y, y, count, static_cast<std::size_t>(count), channel, channel + 1);
    }
  }

  double eps_;
  cv::Mat scale_, shift_;
  cv::Ptr<dnn::ActivationLayer> activation_;
};

thread_local bool is_reading = false;

cv::Ptr<dnn::Layer> makeNormalization(dnn::LayerParams& params) {
  const bool as_here =
      params.get<bool>("normalize_variance", true) && !params.get<bool>("across_channels", false);
  if (!is_reading || !as_here) return dnn::MVNLayer::create(params);
  return cv::makePtr<ChannelNormalization>(params);
}

cv::Ptr<dnn::Layer> makeConvolution(dnn::LayerParams& params) {
  if (is_reading) return makeFastConvolution(params);
  return dnn::ConvolutionLayer::create(params);
}

/// OpenCV's list of layers is the whole process's: ours are in it only while a network is read.
class Registration {
 public:
  Registration() : lock_(mutex()) {
    dnn::LayerFactory::registerLayer("MVN", makeNormalization);
    dnn::LayerFactory::registerLayer("Convolution", makeConvolution);
    is_reading = true;
  }
  ~Registration() {
    is_reading = false;
    dnn::LayerFactory::unregisterLayer("Convolution");
    dnn::LayerFactory::unregisterLayer("MVN");
  }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }

  std::lock_guard<std::mutex> lock_;
};

}  // namespace

dnn::Net readWithFastLayers(const std::function<dnn::Net()>& read) {
  const Registration registration;
  dnn::Net net = read();
  // Layers are made when they are first asked for.
  for (const auto& name : net.getLayerNames()) net.getLayer(net.getLayerId(name));
  return net;
}

}  // namespace pf

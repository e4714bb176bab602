// SPDX-License-Identifier: BSD-3-Clause
#include "pointwise_layer.hpp"

#include <opencv2/dnn/all_layers.hpp>

#include "pointwise_kernel.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

namespace dnn = cv::dnn;

// A part of an image whose channels, in and out, stay in the second-level cache.
constexpr std::size_t kPixelsAtOnce = 128;

class PointwiseConvolution : public dnn::Layer {
 public:
  PointwiseConvolution(const dnn::LayerParams& params,
                       const cv::Ptr<dnn::BaseConvolutionLayer>& convolution)
      : convolution_(convolution) {
    setParamsFrom(params);
    outputs_ = blobs[0].size[0];
    inputs_ = blobs[0].size[1];
    weights_ = blobs[0].reshape(1, outputs_).clone();
    bias_ = blobs.size() > 1 ? blobs[1].reshape(1, outputs_).clone()
                             : cv::Mat::zeros(outputs_, 1, CV_32FC1);
  }

  bool getMemoryShapes(const std::vector<dnn::MatShape>& inputs, int outputs_needed,
                       std::vector<dnn::MatShape>& outputs,
                       std::vector<dnn::MatShape>& internals) const override {
    return convolution_->getMemoryShapes(inputs, outputs_needed, outputs, internals);
  }

  void finalize(cv::InputArrayOfArrays inputs, cv::OutputArrayOfArrays outputs) override {
    convolution_->finalize(inputs, outputs);
  }

  bool tryFuse(cv::Ptr<dnn::Layer>& next) override {
    cv::Mat scale, shift;
    next->getScaleShift(scale, shift);
    if (activation_ || (scale.empty() && shift.empty()) || !fits(scale) || !fits(shift) ||
        !convolution_->tryFuse(next)) {
      return false;
    }
    for (int o = 0; o < outputs_; ++o) {
      const float factor = valueOf(scale, o, 1.0F);
      weights_.row(o) *= factor;
      bias_.at<float>(o) = bias_.at<float>(o) * factor + valueOf(shift, o, 0.0F);
    }
    packed_ = {};
    return true;
  }

  bool setActivation(const cv::Ptr<dnn::ActivationLayer>& activation) override {
    activation_ = activation;
    return convolution_->setActivation(activation);
  }

  void unsetAttached() override {
    activation_.release();
    convolution_->unsetAttached();
  }

  void forward(cv::InputArrayOfArrays inputs, cv::OutputArrayOfArrays outputs,
               cv::OutputArrayOfArrays internals) override {
    std::vector<cv::Mat> in, out;
    inputs.getMatVector(in);
    outputs.getMatVector(out);
    const std::size_t pixels = in[0].dims == 4 ? in[0].total(2) : 0;
    if (pixels < kernel::kLeastPixels || in[0].size[1] != inputs_ || out[0].total(2) != pixels) {
      convolution_->forward(inputs, outputs, internals);
      return;
    }
    if (packed_.outputs == 0) {
      packed_ = kernel::PointwiseWeights::packed(weights_.ptr<float>(), bias_.ptr<float>(),
                                                 outputs_, inputs_);
    }
    for (int image = 0; image < in[0].size[0]; ++image) {
      convolve(in[0].ptr<float>(image), pixels, out[0].ptr<float>(image));
    }
  }

 private:
  bool fits(const cv::Mat& values) const {
    return values.empty() || values.total() == 1 ||
           values.total() == static_cast<std::size_t>(outputs_);
  }

  static float valueOf(const cv::Mat& values, int channel, float otherwise) {
    if (values.empty()) return otherwise;
    return values.at<float>(values.total() == 1 ? 0 : channel);
  }

  void convolve(const float* in, std::size_t pixels, float* out) const {
    // What is left over belongs to the last part: none is too small.
    const std::size_t parts = std::max<std::size_t>(1, pixels / kPixelsAtOnce);
    parallelFor(parts, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t part = first; part < last; ++part) {
        const std::size_t begin = part * kPixelsAtOnce;
        const std::size_t end = part + 1 == parts ? pixels : begin + kPixelsAtOnce;
        kernel::convolvePixels(packed_, in, pixels, begin, end, out);
        if (!activation_) continue;
        for (int o = 0; o < outputs_; ++o) {
          float* values = out + static_cast<std::size_t>(o) * pixels + begin;
          activation_->forwardSlice(values, values, static_cast<int>(end - begin), pixels, o,
                                    o + 1);
        }
      }
    });
  }

  cv::Ptr<dnn::BaseConvolutionLayer> convolution_;
  cv::Ptr<dnn::ActivationLayer> activation_;
  int outputs_, inputs_;
  cv::Mat weights_, bias_;           // outputs x inputs, outputs x 1, with what was fused into them
  kernel::PointwiseWeights packed_;  // of these; made when first needed
};

}  // namespace

cv::Ptr<dnn::Layer> makePointwise(dnn::LayerParams& params) {
  if (params.blobs.empty()) return {};
  const cv::Mat& weights = params.blobs[0];
  if (weights.type() != CV_32FC1 || weights.dims != 4 || weights.size[2] != 1 ||
      weights.size[3] != 1) {
    return {};
  }
  const auto convolution = dnn::ConvolutionLayer::create(params);
  for (const std::size_t stride : convolution->strides) {
    if (stride != 1) return {};
  }
  return cv::makePtr<PointwiseConvolution>(params, convolution);
}

}  // namespace pf

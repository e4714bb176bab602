// SPDX-License-Identifier: BSD-3-Clause
#include "convolution_layers.hpp"

#include <algorithm>
#include <opencv2/dnn/all_layers.hpp>

#include "pointwise_kernel.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

namespace dnn = cv::dnn;

constexpr std::size_t kChannelsAtOnce = 2;
// A part of an image whose channels, in and out, stay in the second-level cache.
constexpr std::size_t kPixelsAtOnce = 128;

/// A convolution that is computed here where it can be, else by OpenCV's.
class FastConvolution : public dnn::Layer {
 public:
  FastConvolution(const dnn::LayerParams& params,
                  const cv::Ptr<dnn::BaseConvolutionLayer>& convolution)
      : convolution_(convolution) {
    setParamsFrom(params);
    type = "FastConvolution";  // from 4.7 on, OpenCV takes a "Convolution" for a layer of its own
  }

  bool getMemoryShapes(const std::vector<dnn::MatShape>& inputs, int outputs_needed,
                       std::vector<dnn::MatShape>& outputs,
                       std::vector<dnn::MatShape>& internals) const override {
    return convolution_->getMemoryShapes(inputs, outputs_needed, outputs, internals);
  }

  void finalize(cv::InputArrayOfArrays inputs, cv::OutputArrayOfArrays outputs) override {
    convolution_->finalize(inputs, outputs);
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
    if (in[0].dims != 4 || in[0].total(2) != out[0].total(2) || !fits(in[0])) {
      convolution_->forward(inputs, outputs, internals);
      return;
    }
    for (int image = 0; image < in[0].size[0]; ++image) {
      convolve(in[0].ptr<float>(image), in[0].total(2), out[0].ptr<float>(image));
    }
  }

 protected:
  /// `in`: images x channels x height x width.
  virtual bool fits(const cv::Mat& in) const = 0;
  /// One image; `pixels` of a channel, all in a row.
  virtual void convolve(const float* in, std::size_t pixels, float* out) = 0;

  void activate(int channel, std::size_t begin, std::size_t end, std::size_t pixels,
                float* out) const {
    if (!activation_) return;
    float* values = out + static_cast<std::size_t>(channel) * pixels + begin;
    activation_->forwardSlice(values, values, static_cast<int>(end - begin), pixels, channel,
                              channel + 1);
  }

  cv::Ptr<dnn::BaseConvolutionLayer> convolution_;
  cv::Ptr<dnn::ActivationLayer> activation_;
};

/// One weight for each output channel: where it has as many input channels, it scales them.
class ChannelScale : public FastConvolution {
 public:
  using FastConvolution::FastConvolution;

 private:
  bool fits(const cv::Mat& in) const override { return in.size[1] == blobs[0].size[0]; }

  void convolve(const float* in, std::size_t pixels, float* out) override {
    const auto channels = static_cast<std::size_t>(blobs[0].size[0]);
    parallelFor(channels, kChannelsAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        kernel::applyLine(in + k * pixels, static_cast<int>(pixels), blobs[0].ptr<float>()[k],
                          blobs.size() > 1 ? blobs[1].ptr<float>()[k] : 0.0F, out + k * pixels);
        activate(static_cast<int>(k), 0, pixels, pixels, out);
      }
    });
  }
};

/// Every output channel is a weighted sum of the input channels of the same pixel.
class PointwiseConvolution : public FastConvolution {
 public:
  PointwiseConvolution(const dnn::LayerParams& params,
                       const cv::Ptr<dnn::BaseConvolutionLayer>& convolution)
      : FastConvolution(params, convolution),
        outputs_(blobs[0].size[0]),
        inputs_(blobs[0].size[1]),
        weights_(blobs[0].reshape(1, outputs_).clone()),
        bias_(blobs.size() > 1 ? blobs[1].reshape(1, outputs_).clone()
                               : cv::Mat::zeros(outputs_, 1, CV_32FC1)) {}

  bool tryFuse(cv::Ptr<dnn::Layer>& next) override {
    cv::Mat scale, shift;
    next->getScaleShift(scale, shift);
    if (activation_ || (scale.empty() && shift.empty()) || !isForEach(scale) || !isForEach(shift) ||
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

 private:
  bool isForEach(const cv::Mat& values) const {
    return values.empty() || values.total() == 1 ||
           values.total() == static_cast<std::size_t>(outputs_);
  }

  static float valueOf(const cv::Mat& values, int channel, float otherwise) {
    if (values.empty()) return otherwise;
    return values.at<float>(values.total() == 1 ? 0 : channel);
  }

  bool fits(const cv::Mat& in) const override {
    return in.total(2) >= kernel::kLeastPixels && in.size[1] == inputs_;
  }

  void convolve(const float* in, std::size_t pixels, float* out) override {
    if (packed_.outputs == 0) {
      packed_ = kernel::PointwiseWeights::packed(weights_.ptr<float>(), bias_.ptr<float>(),
                                                 outputs_, inputs_);
    }
    // What is left over belongs to the last part: none is too small.
    const std::size_t parts = std::max<std::size_t>(1, pixels / kPixelsAtOnce);
    parallelFor(parts, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t part = first; part < last; ++part) {
        const std::size_t begin = part * kPixelsAtOnce;
        const std::size_t end = part + 1 == parts ? pixels : begin + kPixelsAtOnce;
        kernel::convolvePixels(packed_, in, pixels, begin, end, out);
        for (int o = 0; o < outputs_; ++o) activate(o, begin, end, pixels, out);
      }
    });
  }

  int outputs_, inputs_;
  cv::Mat weights_, bias_;           // outputs x inputs, outputs x 1, with what was fused into them
  kernel::PointwiseWeights packed_;  // of these; made when first needed
};

bool hasUnitStride(const dnn::BaseConvolutionLayer& convolution) {
  return std::all_of(convolution.strides.begin(), convolution.strides.end(),
                     [](std::size_t stride) { return stride == 1; });
}

}  // namespace

cv::Ptr<dnn::Layer> makeFastConvolution(dnn::LayerParams& params) {
  const cv::Ptr<dnn::BaseConvolutionLayer> convolution = dnn::ConvolutionLayer::create(params);
  if (params.blobs.empty() || params.blobs[0].type() != CV_32FC1 || params.blobs[0].dims != 4 ||
      !hasUnitStride(*convolution)) {
    return convolution;
  }
  const cv::Mat& weights = params.blobs[0];
  if (weights.size[2] != 1 || weights.size[3] != 1) return convolution;
  if (weights.size[1] == 1) return cv::makePtr<ChannelScale>(params, convolution);
  return cv::makePtr<PointwiseConvolution>(params, convolution);
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/network_layers.hpp"

#include <gtest/gtest.h>

#include <opencv2/dnn/all_layers.hpp>

#include "../src/pose/pointwise_kernel.hpp"

namespace pf {
namespace {

namespace dnn = cv::dnn;

cv::Mat randomBlob(const std::vector<int>& shape, double low, double high, int seed) {
  cv::Mat blob(shape, CV_32F);
  cv::RNG(static_cast<std::uint64_t>(seed)).fill(blob, cv::RNG::UNIFORM, low, high);
  return blob;
}

void addConvolution(dnn::Net& net, const std::string& name, int outputs, bool bias, bool same) {
  dnn::LayerParams params;
  params.set("num_output", outputs);
  params.set("kernel_size", 1);
  params.set("bias_term", bias);
  if (same) params.set("pad_mode", "SAME");
  params.blobs.push_back(randomBlob({outputs, 1, 1, 1}, -2.0, 2.0, 1));
  if (bias) params.blobs.push_back(randomBlob({1, outputs}, -1.0, 1.0, 2));
  net.addLayerToPrev(name, "Convolution", params);
}

/// A convolution of 1x1 pixels or larger ones.
void addConvolution(dnn::Net& net, int inputs, int outputs, int kernel, int stride, int groups) {
  dnn::LayerParams params;
  params.set("num_output", outputs);
  params.set("kernel_size", kernel);
  params.set("pad", kernel / 2);
  params.set("stride", stride);
  params.set("group", groups);
  params.set("bias_term", outputs % 2 == 0);
  params.blobs.push_back(randomBlob({outputs, inputs / groups, kernel, kernel}, -1.0, 1.0, 7));
  if (outputs % 2 == 0) params.blobs.push_back(randomBlob({1, outputs}, -1.0, 1.0, 8));
  net.addLayerToPrev("convolution", "Convolution", params);
}

void addNormalization(dnn::Net& net, int channels) {
  dnn::LayerParams mvn;
  mvn.set("eps", 0.001);
  net.addLayerToPrev("mvn", "MVN", mvn);
  dnn::LayerParams batch;
  batch.set("eps", 0.0);
  batch.set("has_weight", true);
  batch.set("has_bias", true);
  batch.blobs = {cv::Mat::zeros(1, channels, CV_32F), cv::Mat::ones(1, channels, CV_32F),
                 randomBlob({1, channels}, 0.5, 2.0, 3), randomBlob({1, channels}, -1.0, 1.0, 4)};
  net.addLayerToPrev("batch", "BatchNorm", batch);
  dnn::LayerParams relu;
  net.addLayerToPrev("relu", "ReLU6", relu);
}

/// Scale, normalisation, scale; behind each an activation.
dnn::Net chain(int channels, bool bias) {
  dnn::Net net;
  addConvolution(net, "scale", channels, bias, false);
  addNormalization(net, channels);
  addConvolution(net, "again", channels, !bias, true);
  dnn::LayerParams relu;
  net.addLayerToPrev("relu_again", "ReLU", relu);
  return net;
}

cv::Mat run(dnn::Net net, const cv::Mat& input) {
  net.setPreferableBackend(dnn::DNN_BACKEND_OPENCV);
  net.setInput(input);
  return net.forward().clone();
}

std::string typeName(const cv::Ptr<dnn::Layer>& layer) { return typeid(*layer).name(); }

TEST(NetworkLayers, ComputeWhatOpenCvDoes) {
  for (const bool bias : {false, true}) {
    for (const cv::Size size : {cv::Size(54, 40), cv::Size(7, 3), cv::Size(1, 1)}) {
      const int channels = 5;
      const auto read = [&] { return chain(channels, bias); };
      // A large mean: digits must not be lost in it.
      const cv::Mat input = randomBlob({1, channels, size.height, size.width}, 50.0, 60.0, 5);
      const cv::Mat expected = run(read(), input), found = run(readWithFastLayers(read), input);
      ASSERT_EQ(found.total(), expected.total());
      EXPECT_LT(cv::norm(found, expected, cv::NORM_INF), 2e-3) << size << bias;
      EXPECT_GT(cv::norm(expected, cv::NORM_INF), 0.1);
    }
  }
}

TEST(NetworkLayers, AConvolutionThatSpreadsOneChannelStaysOne) {
  const auto read = [] {
    dnn::Net net;
    addConvolution(net, "spread", 6, true, false);
    return net;
  };
  const cv::Mat input = randomBlob({1, 1, 9, 11}, -1.0, 1.0, 6);
  const cv::Mat expected = run(read(), input), found = run(readWithFastLayers(read), input);
  ASSERT_EQ(found.total(), 6U * 9U * 11U);
  EXPECT_LT(cv::norm(found, expected, cv::NORM_INF), 1e-6);
}

TEST(NetworkLayers, ConvolutionsOfSinglePixelsComputeWhatOpenCvDoes) {
  struct Case {
    int inputs, outputs, kernel, stride, groups;
    bool is_ours;
  };
  for (const Case& c :
       {Case{64, 64, 1, 1, 1, true}, Case{9, 19, 1, 1, 1, true}, Case{16, 8, 1, 1, 2, true},
        Case{8, 14, 1, 2, 1, false}, Case{3, 5, 3, 1, 1, false}}) {
    for (const cv::Size size :
         {cv::Size(54, 40), cv::Size(33, 1), cv::Size(17, 23), cv::Size(2, 3)}) {
      const auto read = [&c] {
        dnn::Net net;
        addConvolution(net, c.inputs, c.outputs, c.kernel, c.stride, c.groups);
        dnn::LayerParams scale;
        scale.set("bias_term", true);
        scale.blobs = {randomBlob({1, c.outputs}, 0.5, 2.0, 9),
                       randomBlob({1, c.outputs}, -1.0, 1.0, 10)};
        net.addLayerToPrev("behind", "Scale", scale);
        dnn::LayerParams relu;
        net.addLayerToPrev("relu", "ReLU6", relu);
        return net;
      };
      const cv::Mat input = randomBlob({2, c.inputs, size.height, size.width}, -1.0, 1.0, 11);
      dnn::Net plain = read(), fast = readWithFastLayers(read);
      EXPECT_EQ(typeName(fast.getLayer(fast.getLayerId("convolution"))) !=
                    typeName(plain.getLayer(plain.getLayerId("convolution"))),
                c.is_ours);
      const cv::Mat expected = run(plain, input), found = run(fast, input);
      ASSERT_EQ(found.total(), expected.total());
      EXPECT_LT(cv::norm(found, expected, cv::NORM_INF), 1e-4) << size << c.inputs;
      EXPECT_GT(cv::norm(expected, cv::NORM_INF), 0.1);
    }
  }
}

TEST(NetworkLayers, SinglePixelsAreConvolvedToTheSameBitsOnAnyMachine) {
  constexpr int kInputs = 37, kOutputs = 20;
  for (const std::size_t pixels : {32U, 33U, 63U, 64U, 300U}) {
    const cv::Mat weights = randomBlob({kOutputs, kInputs}, -1.0, 1.0, 12);
    const cv::Mat bias = randomBlob({1, kOutputs}, -1.0, 1.0, 13);
    const cv::Mat in = randomBlob({kInputs, static_cast<int>(pixels)}, -1.0, 1.0, 14);
    cv::Mat out(kOutputs, static_cast<int>(pixels), CV_32FC1, cv::Scalar(-100));
    const auto packed = kernel::PointwiseWeights::packed(weights.ptr<float>(), bias.ptr<float>(),
                                                         kOutputs, kInputs);
    kernel::convolvePixels(packed, in.ptr<float>(), pixels, 0, pixels, out.ptr<float>());
    for (int o = 0; o < kOutputs; ++o) {
      for (int p = 0; p < out.cols; ++p) {
        float sum = bias.at<float>(o);
        for (int i = 0; i < kInputs; ++i) sum += in.at<float>(i, p) * weights.at<float>(o, i);
        ASSERT_EQ(out.at<float>(o, p), sum) << o << " " << p << " of " << pixels;
      }
    }
  }
}

TEST(NetworkLayers, OtherNetworksKeepTheirs) {
  const auto read = [] { return chain(4, true); };
  dnn::Net before = read(), fast = readWithFastLayers(read), after = read();
  for (const char* name : {"scale", "mvn"}) {
    const auto plain = typeName(before.getLayer(before.getLayerId(name)));
    EXPECT_NE(typeName(fast.getLayer(fast.getLayerId(name))), plain);
    EXPECT_EQ(typeName(after.getLayer(after.getLayerId(name))), plain);
  }
  EXPECT_THROW(readWithFastLayers([]() -> dnn::Net { throw std::runtime_error("unreadable"); }),
               std::runtime_error);
  dnn::Net last = read();
  EXPECT_EQ(typeName(last.getLayer(last.getLayerId("mvn"))),
            typeName(before.getLayer(before.getLayerId("mvn"))));
}

}  // namespace
}  // namespace pf

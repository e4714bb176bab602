// SPDX-License-Identifier: BSD-3-Clause
// The network that scripts/get_models makes for OpenCV computes what the reference edit computes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/dnn.hpp>

namespace {

namespace fs = std::filesystem;

fs::path modelFolder() {
  const char* data = std::getenv("POSEFUSION_TEST_DATA");
  return (data != nullptr ? fs::path(data) : fs::path("../shared/data")).parent_path() / "models";
}

cv::Mat infer(const fs::path& model, const cv::Mat& input) {
  cv::dnn::Net net = cv::dnn::readNetFromTensorflow(model.string());
  net.enableFusion(false);
  net.setInput(input);
  return net.forward().clone();
}

TEST(ModelEdit, ComputesTheSameAsTheReference) {
  const fs::path original = modelFolder() / "tf_pose_mobilenet_v2_small.pb";
  const fs::path reference = modelFolder() / "tf_pose_mobilenet_v2_small.opencv.pb";
  if (!fs::exists(original) || !fs::exists(reference)) {
    GTEST_SKIP() << "skipped: no test data at " << modelFolder().string();
  }
  std::string folder = (fs::temp_directory_path() / "posefusion_model_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const std::string command = "scripts/get_models tf_pose_mobilenet_v2_small --from '" +
                              original.string() + "' --output '" + folder + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);

  int shape[] = {1, 3, 176, 240};
  cv::Mat input(4, shape, CV_32F);
  cv::RNG random(5);
  random.fill(input, cv::RNG::UNIFORM, -1.0, 1.0);
  const cv::Mat made = infer(fs::path(folder) / reference.filename(), input);
  const cv::Mat expected = infer(reference, input);
  fs::remove_all(folder);
  ASSERT_EQ(made.total(), expected.total());
  EXPECT_GT(cv::norm(expected, cv::NORM_INF), 0.01) << "something to compare";
  EXPECT_EQ(cv::norm(made.reshape(1, 1), expected.reshape(1, 1), cv::NORM_INF), 0.0);
}

}  // namespace

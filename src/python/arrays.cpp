// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/trajectory_format.hpp"

namespace pf {
namespace {

namespace py = pybind11;

constexpr py::ssize_t kTumColumns = 8;

std::string typeOf(const py::handle& given) {
  return py::str(given.attr("__class__").attr("__name__"));
}

std::string shapeOf(const py::array& array) { return py::str(array.attr("shape")); }

py::array requireArray(const py::handle& given, const char* what) {
  if (py::isinstance<py::array>(given)) return py::reinterpret_borrow<py::array>(given);
  throw InputError(std::string(what) + " is " + typeOf(given) + ", expected a numpy array");
}

/// OpenCV knows rows that are apart from each other, but no other gaps.
bool isDescribable(const py::array& array) {
  const bool is_aligned =
      (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0 || array.itemsize() == 1;
  py::ssize_t packed = array.itemsize();
  for (py::ssize_t axis = array.ndim() - 1; axis > 0; --axis) {
    if (array.shape(axis) > 1 && array.strides(axis) != packed) return false;
    packed *= array.shape(axis);
  }
  return is_aligned && (array.shape(0) == 1 || array.strides(0) >= packed);
}

/// `type`: OpenCV's, of a pixel.
ImageView viewOf(py::array array, int type) {
  if (!isDescribable(array)) {
    array = py::array::ensure(array, py::array::c_style | py::detail::npy_api::NPY_ARRAY_ALIGNED_);
    if (!array) throw py::error_already_set();
  }
  const int rows = static_cast<int>(array.shape(0)), cols = static_cast<int>(array.shape(1));
  const std::size_t step =
      rows > 1 ? static_cast<std::size_t>(array.strides(0)) : std::size_t{cv::Mat::AUTO_STEP};
  void* const pixels = const_cast<void*>(array.data());  // the core does not write into frames
  return {array, cv::Mat(rows, cols, type, pixels, step)};
}

void requireSize(const py::array& array, bool is_shape, const char* what, const char* expected) {
  if (is_shape && array.shape(0) > 0 && array.shape(1) > 0 && array.shape(0) <= INT16_MAX &&
      array.shape(1) <= INT16_MAX) {
    return;
  }
  throw InputError(std::string(what) + " has the shape " + shapeOf(array) + ", expected " +
                   expected);
}

StampedPose poseOf(const double* row) {
  StampedPose pose;
  pose.stamp_ns = stampOf(py::float_(row[0]));
  const auto rotation = rotationOf({row[7], row[4], row[5], row[6]});
  if (!rotation) throw InputError("the quaternion is not of unit length");
  pose.T_world_camera.linear() = *rotation;
  pose.T_world_camera.translation() = Eigen::Vector3d(row[1], row[2], row[3]);
  if (!pose.T_world_camera.translation().allFinite()) throw InputError("a position is not finite");
  return pose;
}

Trajectory readRows(const py::array_t<double, py::array::c_style>& rows, const char* what) {
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    try {
      trajectory.push_back(poseOf(rows.data(i, 0)));
    } catch (const InputError& error) {
      throw InputError(std::string(what) + ", row " + std::to_string(i) + ": " + error.what());
    }
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return trajectory;
}

}  // namespace

ImageView colorImage(const py::handle& given) {
  const py::array array = requireArray(given, "color");
  requireSize(array, array.ndim() == 3 && array.shape(2) == 3, "color", "(height, width, 3)");
  if (!py::isinstance<py::array_t<std::uint8_t>>(array)) {
    throw InputError("color is of " + std::string(py::str(array.dtype())) + ", expected uint8");
  }
  return viewOf(array, CV_8UC3);
}

ImageView depthImage(const py::handle& given) {
  const py::array array = requireArray(given, "depth");
  requireSize(array, array.ndim() == 2, "depth", "(height, width)");
  if (py::isinstance<py::array_t<std::uint16_t>>(array)) return viewOf(array, CV_16UC1);
  if (py::isinstance<py::array_t<float>>(array)) return viewOf(array, CV_32FC1);
  throw InputError("depth is of " + std::string(py::str(array.dtype())) +
                   ", expected uint16, or float32 in metres");
}

std::int64_t stampOf(const py::handle& given) {
  if (PyFloat_Check(given.ptr())) {
    const double seconds = given.cast<double>();
    if (!std::isfinite(seconds)) {
      throw InputError("stamp is " + std::string(py::repr(given)) + ", expected a time");
    }
    return parseStamp(py::repr(py::float_(seconds)));
  }
  if (PyIndex_Check(given.ptr()) != 0 && !PyBool_Check(given.ptr())) {
    const py::object whole = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
    int overflow = 0;
    const long long value = whole ? PyLong_AsLongLongAndOverflow(whole.ptr(), &overflow)
                                  : (throw py::error_already_set());
    if (overflow == 0) return value;
  }
  throw InputError("stamp is " + std::string(py::repr(given)) +
                   ", expected a float in seconds or an int in nanoseconds");
}

std::string pathOf(const py::handle& given, const char* what) {
  const py::object path = py::reinterpret_steal<py::object>(PyOS_FSPath(given.ptr()));
  if (!path) {
    PyErr_Clear();
    throw InputError(std::string(what) + " is " + typeOf(given) + ", expected a path");
  }
  return path.cast<std::string>();
}

Trajectory trajectoryOf(const py::handle& given, const char* what) {
  if (!py::isinstance<py::array>(given)) return readTrajectory(pathOf(given, what)).poses;
  const auto rows = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!rows || rows.ndim() != 2 || rows.shape(1) != kTumColumns) {
    PyErr_Clear();
    throw InputError(std::string(what) + " has the shape " +
                     shapeOf(py::reinterpret_borrow<py::array>(given)) +
                     ", expected (N, 8): stamp tx ty tz qx qy qz qw");
  }
  return readRows(rows, what);
}

py::array_t<double> arrayOf(const Trajectory& trajectory) {
  std::vector<double> rows;
  rows.reserve(trajectory.size() * static_cast<std::size_t>(kTumColumns));
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d t = pose.T_world_camera.translation();
    Eigen::Quaterniond q(pose.T_world_camera.linear());
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    rows.insert(rows.end(), {1e-9 * static_cast<double>(pose.stamp_ns), t.x(), t.y(), t.z(), q.x(),
                             q.y(), q.z(), q.w()});
  }
  return arrayOf(std::move(rows), {static_cast<py::ssize_t>(trajectory.size()), kTumColumns});
}

py::array arrayOf(const cv::Mat& image) {
  if (image.empty()) return py::array_t<std::uint8_t>(std::vector<py::ssize_t>{0, 0});
  auto* const kept = new cv::Mat(image);
  const py::capsule owner(kept, [](void* p) { delete static_cast<cv::Mat*>(p); });
  const auto size = static_cast<py::ssize_t>(image.elemSize1());
  std::vector<py::ssize_t> shape{image.rows, image.cols};
  std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(image.step[0]),
                                   static_cast<py::ssize_t>(image.elemSize())};
  if (image.channels() > 1) {
    shape.push_back(image.channels());
    strides.push_back(size);
  }
  const py::dtype type = image.depth() == CV_8U    ? py::dtype::of<std::uint8_t>()
                         : image.depth() == CV_16U ? py::dtype::of<std::uint16_t>()
                                                   : py::dtype::of<float>();
  return py::array(type, shape, strides, kept->data, owner);
}

py::array_t<double> arrayOf(const Eigen::Isometry3d& T) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = T.matrix();
  return arrayOf(std::vector<double>(rows.data(), rows.data() + rows.size()), {4, 4});
}

}  // namespace pf

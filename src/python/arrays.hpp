// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "posefusion/core/trajectory.hpp"

namespace pf {

/// What Python gives, as the core takes it, and back. All throw InputError naming the argument and
/// what was expected; all need Python's lock.

/// A matrix on the pixels of an array where OpenCV can describe how they lie, else on those of a
/// copy; `keep` holds what they belong to and must live as long.
struct ImageView {
  pybind11::array keep;
  cv::Mat image;
};

/// H x W x 3, uint8, R G B.
ImageView colorImage(const pybind11::handle& given);

/// H x W: uint16, or float32 in metres.
ImageView depthImage(const pybind11::handle& given);

/// An int is in nanoseconds, a float in seconds. Seconds are taken as they are printed, so that
/// 1341845820.819654 is that to the microsecond.
std::int64_t stampOf(const pybind11::handle& given);

/// Text, or what has a __fspath__().
std::string pathOf(const pybind11::handle& given, const char* what);

/// N x 8 (stamp (s), position, quaternion x y z w), or a file of such lines.
Trajectory trajectoryOf(const pybind11::handle& given, const char* what);

/// N x 8, float64.
pybind11::array_t<double> arrayOf(const Trajectory& trajectory);

/// Array whose memory the array keeps: nothing is copied.
pybind11::array arrayOf(const cv::Mat& image);

/// 4 x 4, float64.
pybind11::array_t<double> arrayOf(const Eigen::Isometry3d& T);

/// As an array of that shape, which owns the values: nothing is copied.
template <class T>
pybind11::array_t<T> arrayOf(std::vector<T> values, std::vector<pybind11::ssize_t> shape) {
  auto* const owned = new std::vector<T>(std::move(values));
  const pybind11::capsule owner(owned, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return pybind11::array_t<T>(std::move(shape), owned->data(), owner);
}

}  // namespace pf

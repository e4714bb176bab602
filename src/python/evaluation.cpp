// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/pose_comparison.hpp"

#include <cmath>

#include "arrays.hpp"
#include "bindings.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

namespace py = pybind11;

struct PythonErrors {
  PoseErrors errors;
  double scale = 1;
};

struct Pairing {
  std::string align;
  double max_difference_s = 0, offset_s = 0;
};

std::vector<PosePair> pairsOf(const py::object& truth, const py::object& estimate,
                              const Pairing& pairing) {
  require(pairing.max_difference_s > 0 && pairing.max_difference_s < 1e6, "max_difference",
          pairing.max_difference_s, "seconds above 0");
  require(std::abs(pairing.offset_s) < 1e9, "offset", pairing.offset_s, "seconds");
  const Trajectory wanted = trajectoryOf(truth, "truth");
  Trajectory found = trajectoryOf(estimate, "estimate");
  for (auto& pose : found) pose.stamp_ns += std::llround(1e9 * pairing.offset_s);
  return matchPoses(wanted, found, std::llround(1e9 * pairing.max_difference_s));
}

PythonErrors ate(const py::object& truth, const py::object& estimate, const std::string& align,
                 double max_difference_s, double offset_s) {
  const auto pairs = pairsOf(truth, estimate, {align, max_difference_s, offset_s});
  const Alignment alignment = alignmentOf(pairs, alignByNamed(align));
  return {absolutePoseErrors(pairs, alignment), alignment.scale};
}

PythonErrors rpe(const py::object& truth, const py::object& estimate, double step,
                 const std::string& unit, bool overlapping, const std::string& align,
                 double max_difference_s, double offset_s) {
  const auto pairs = pairsOf(truth, estimate, {align, max_difference_s, offset_s});
  const Alignment alignment = alignmentOf(pairs, alignByNamed(align));
  const Step steps{step, stepUnitNamed(unit), overlapping};
  return {relativePoseErrors(pairs, alignment, steps), alignment.scale};
}

void addStatistics(py::module& module) {
  py::class_<ErrorStatistics>(module, "Statistics")
      .def_readonly("count", &ErrorStatistics::count)
      .def_readonly("rmse", &ErrorStatistics::rmse)
      .def_readonly("mean", &ErrorStatistics::mean)
      .def_readonly("median", &ErrorStatistics::median)
      .def_readonly("std", &ErrorStatistics::deviation)
      .def_readonly("min", &ErrorStatistics::min)
      .def_readonly("max", &ErrorStatistics::max)
      .def_readonly("sse", &ErrorStatistics::squares_sum)
      .def("__repr__", [](const ErrorStatistics& s) {
        return "<rmse " + std::to_string(s.rmse) + " of " + std::to_string(s.count) + ">";
      });
  py::class_<PythonErrors>(module, "Errors")
      .def_property_readonly("translation_m",
                             [](const PythonErrors& e) { return e.errors.translation_m; })
      .def_property_readonly("rotation_deg",
                             [](const PythonErrors& e) { return e.errors.rotation_deg; })
      .def_readonly("scale", &PythonErrors::scale);
}

}  // namespace

void addEvaluation(py::module& module) {
  addStatistics(module);
  module.def("ate", &ate, py::arg("truth"), py::arg("estimate"), py::arg("align") = "rigid",
             py::arg("max_difference") = 0.02, py::arg("offset") = 0.0);
  module.def("rpe", &rpe, py::arg("truth"), py::arg("estimate"), py::arg("step") = 1.0,
             py::arg("unit") = "frames", py::arg("overlapping") = false, py::arg("align") = "rigid",
             py::arg("max_difference") = 0.02, py::arg("offset") = 0.0);
}

}  // namespace pf

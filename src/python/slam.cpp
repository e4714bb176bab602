// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/slam.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

namespace py = pybind11;

/// The chain for any number of Python's threads: while one is in it, Python goes on, and a second
/// one waits.
class PythonSlam {
 public:
  PythonSlam(const Config& config, PythonRecording* recording)
      : slam_(recording != nullptr ? Slam(config, *recording->source) : Slam(config)) {}

  /// Calls it without Python's lock, and alone.
  template <typename Call>
  auto unlocked(const Call& call) {
    const py::gil_scoped_release released;
    const std::lock_guard<std::mutex> alone(mutex_);
    return call();
  }

  FrameAnswer process(const py::object& color, const py::object& depth, const py::object& stamp,
                      const PythonCamera& camera) {
    const ImageView colors = colorImage(color), depths = depthImage(depth);
    RgbdFrame frame;
    frame.stamp_ns = stampOf(stamp);
    frame.color = colors.image;
    frame.depth = depths.image;
    frame.depth_unit_m = camera.depth_unit_m;
    frame.camera = camera.pinhole;
    const std::string defect = defectOf(frame);
    if (!defect.empty()) throw InputError(defect);
    return unlocked([&] { return slam_.process(frame); });
  }

  Slam& slam() { return slam_; }

 private:
  std::mutex mutex_;
  Slam slam_;
};

/// The stable surfels as arrays.
struct PythonMap {
  py::array points, normals, colors, radii, confidences;
};

std::vector<float> rowsOf(const std::vector<float>& x, const std::vector<float>& y,
                          const std::vector<float>& z) {
  std::vector<float> rows;
  rows.reserve(3 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) rows.insert(rows.end(), {x[i], y[i], z[i]});
  return rows;
}

std::vector<std::uint8_t> colorsOf(const SurfelArrays& surfels) {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
  };
  std::vector<std::uint8_t> rows;
  rows.reserve(3 * surfels.size());
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    rows.insert(rows.end(), {byte(surfels.r[i]), byte(surfels.g[i]), byte(surfels.b[i])});
  }
  return rows;
}

PythonMap mapOf(PythonSlam& slam) {
  SurfelArrays surfels = slam.unlocked([&] { return slam.slam().surfels(); });
  const auto count = static_cast<py::ssize_t>(surfels.size());
  PythonMap map;
  map.points = arrayOf(rowsOf(surfels.x, surfels.y, surfels.z), {count, 3});
  map.normals = arrayOf(rowsOf(surfels.nx, surfels.ny, surfels.nz), {count, 3});
  map.colors = arrayOf(colorsOf(surfels), {count, 3});
  map.radii = arrayOf(std::move(surfels.radius), {count});
  for (float& odds : surfels.odds) odds = static_odds::probability(odds);
  map.confidences = arrayOf(std::move(surfels.odds), {count});
  return map;
}

std::size_t save(PythonSlam& slam, const py::object& path) {
  const std::string folder = pathOf(path, "path");
  return slam.unlocked([&] {
    makeFolder(folder);
    slam.slam().saveTrajectory(folder + "/trajectory.txt");
    return slam.slam().saveMap(folder + "/map.ply");
  });
}

void addAnswer(py::module& module) {
  py::class_<FrameAnswer>(module, "Result", "What is known of the camera after a frame.")
      .def_readonly("stamp", &FrameAnswer::stamp_ns, "ns")
      .def_property_readonly("status",
                             [](const FrameAnswer& a) { return std::string(name(a.state)); })
      .def_property_readonly("outcome",
                             [](const FrameAnswer& a) { return std::string(name(a.outcome)); })
      .def_readonly("reason", &FrameAnswer::reason, "Why the frame was not fused; empty: it was.")
      .def_property_readonly("T_world_camera",
                             [](const FrameAnswer& a) -> py::object {
                               if (!a.located) return py::none();
                               return arrayOf(a.T_world_camera);
                             })
      .def_property_readonly(
          "covariance",
          [](const FrameAnswer& a) {
            const auto& c = a.covariance;  // symmetric: by rows as by columns
            return arrayOf(std::vector<double>(c.data(), c.data() + c.size()), {6, 6});
          })
      .def("__repr__", [](const FrameAnswer& a) {
        return "<posefusion.Result " + std::string(name(a.state)) + ", " +
               (a.reason.empty() ? std::string(name(a.outcome)) : a.reason) + ">";
      });
}

void addMap(py::module& module) {
  py::class_<PythonMap>(module, "Map", "Discs of the map, in the world, m.")
      .def_readonly("points", &PythonMap::points)
      .def_readonly("normals", &PythonMap::normals)
      .def_readonly("colors", &PythonMap::colors)
      .def_readonly("radii", &PythonMap::radii)
      .def_readonly("confidences", &PythonMap::confidences)
      .def("__len__", [](const PythonMap& map) { return map.points.shape(0); });
}

}  // namespace

void addSlam(py::module& module) {
  addAnswer(module);
  addMap(module);
  const auto make = [](const py::object& config, const py::object& mode,
                       PythonRecording* recording) {
    const Config settings = configOf(config, mode);
    return std::make_unique<PythonSlam>(settings, recording);
  };
  py::class_<PythonSlam>(module, "Slam", "Colour and depth in; poses and a map without people out.")
      .def(py::init(make), py::arg("config") = py::none(), py::arg("mode") = py::none(),
           py::arg("recording") = py::none())
      .def("process", &PythonSlam::process, py::arg("color"), py::arg("depth"), py::arg("stamp"),
           py::arg("camera"))
      .def("finish", [](PythonSlam& s) { return s.unlocked([&] { return s.slam().finish(); }); })
      .def("trajectory",
           [](PythonSlam& s) { return arrayOf(s.unlocked([&] { return s.slam().trajectory(); })); })
      .def("map", &mapOf)
      .def("save", &save, py::arg("path"));
}

}  // namespace pf

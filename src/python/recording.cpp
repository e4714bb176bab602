// SPDX-License-Identifier: BSD-3-Clause
// Cameras, and recordings to read frames from.
#include <pybind11/stl.h>

#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf {
namespace {

namespace py = pybind11;

PythonCamera makeCamera(int width, int height, double fx, double fy, double cx, double cy,
                        double depth_unit_m) {
  PythonCamera camera;
  camera.pinhole.width = width;
  camera.pinhole.height = height;
  camera.pinhole.fx = fx;
  camera.pinhole.fy = fy;
  camera.pinhole.cx = cx;
  camera.pinhole.cy = cy;
  camera.depth_unit_m = depth_unit_m;
  require(depth_unit_m > 0 && depth_unit_m < 1, "depth_unit_m", depth_unit_m,
          "metres for one step of the depth, above 0");
  validate(camera.pinhole);
  return camera;
}

PythonCamera readCamera(const py::object& path) {
  const CameraFile file = loadCamera(pathOf(path, "camera"));
  return {file.camera, file.depth_factor ? 1.0 / *file.depth_factor : 1e-3};
}

void addCamera(py::module& module) {
  const auto value = [](auto member) {
    return [member](const PythonCamera& camera) { return camera.pinhole.*member; };
  };
  py::class_<PythonCamera>(module, "Camera",
                           "A pinhole camera: pixels, centres at whole coordinates.")
      .def(py::init(&makeCamera), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"),
           py::arg("cx"), py::arg("cy"), py::arg("depth_unit_m") = 1e-3)
      .def_static("load", &readCamera, py::arg("path"),
                  "A camera file: of posefusion, ORB-SLAM, OpenCV or ROS; with its distortion.")
      .def_property_readonly("width", value(&PinholeCamera::width))
      .def_property_readonly("height", value(&PinholeCamera::height))
      .def_property_readonly("fx", value(&PinholeCamera::fx))
      .def_property_readonly("fy", value(&PinholeCamera::fy))
      .def_property_readonly("cx", value(&PinholeCamera::cx))
      .def_property_readonly("cy", value(&PinholeCamera::cy))
      .def_readonly("depth_unit_m", &PythonCamera::depth_unit_m)
      .def("__repr__", [](const PythonCamera& camera) {
        return "<posefusion.Camera " + describe(camera.pinhole) + ">";
      });
}

/// The next frame that can be read.
py::object nextFrame(PythonRecording& recording) {
  std::optional<SourceFrame> next;
  {
    const py::gil_scoped_release unlocked;
    do {
      next = recording.source->next();
    } while (next && !next->defect.empty());
  }
  if (!next) throw py::stop_iteration();
  return py::cast(std::move(next->frame));
}

void addFrame(py::module& module) {
  py::class_<RgbdFrame>(module, "Frame", "A colour and a depth image of one moment.")
      .def_property_readonly("color", [](const RgbdFrame& f) { return arrayOf(f.color); })
      .def_property_readonly("depth", [](const RgbdFrame& f) { return arrayOf(f.depth); })
      .def_readonly("stamp", &RgbdFrame::stamp_ns, "ns")
      .def_property_readonly("camera", [](const RgbdFrame& f) {
        return PythonCamera{f.camera, f.depth_unit_m};
      });
}

}  // namespace

void addRecording(py::module& module) {
  addCamera(module);
  addFrame(module);
  py::class_<PythonRecording>(module, "Recording", "The frames of a folder, one after another.")
      .def("__len__", [](const PythonRecording& r) { return r.source->frameCount(); })
      .def(
          "__iter__", [](PythonRecording& r) -> PythonRecording& { return r; },
          py::return_value_policy::reference_internal)
      .def("__next__", &nextFrame)
      .def("truth", [](PythonRecording& r) { return arrayOf(r.source->truth()); });
  module.def(
      "open_folder",
      [](const py::object& path, const py::object& camera) {
        const std::string folder = pathOf(path, "path");
        return PythonRecording{
            openTumFolder(folder, camera.is_none() ? "" : pathOf(camera, "camera"))};
      },
      py::arg("path"), py::arg("camera") = py::none(),
      "Opens a TUM folder; `camera`: a camera file instead of its own.");
  module.def(
      "read_tum", [](const py::object& path) { return arrayOf(trajectoryOf(path, "path")); },
      py::arg("path"), "A trajectory file (TUM; KITTI and EuRoC are known too) as N x 8.");
  module.def(
      "write_tum",
      [](const py::object& path, const py::array& trajectory, const std::string& comment) {
        saveTrajectory(pathOf(path, "path"), trajectoryOf(trajectory, "trajectory"), comment);
      },
      py::arg("path"), py::arg("trajectory"), py::arg("comment") = "");
}

}  // namespace pf

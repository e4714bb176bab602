// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "bindings.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

namespace py = pybind11;

std::string textOf(const std::string& name, const py::handle& value) {
  if (PyBool_Check(value.ptr())) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (PyFloat_Check(value.ptr())) return py::repr(py::float_(value.cast<double>()));
  if (PyIndex_Check(value.ptr()) != 0) return py::str(value);
  throw InputError("config: " + name + " is " + std::string(py::repr(value)) +
                   ", expected a number, a bool or a text");
}

std::string nameOf(const py::handle& key) {
  if (py::isinstance<py::str>(key)) return key.cast<std::string>();
  throw InputError("config: the key " + std::string(py::repr(key)) + " is no text");
}

void applyDict(Config& config, const py::dict& given) {
  for (const auto& [key, value] : given) {
    const std::string group = nameOf(key);
    if (!py::isinstance<py::dict>(value)) {
      applyAssignment(config, group + "=" + textOf(group, value));
      continue;
    }
    for (const auto& [inner, setting] : py::reinterpret_borrow<py::dict>(value)) {
      const std::string name = group + "." + nameOf(inner);
      applyAssignment(config, name + "=" + textOf(name, setting));
    }
  }
}

}  // namespace

Config configOf(const py::object& given, const py::object& mode) {
  Config config;
  const bool is_dict = py::isinstance<py::dict>(given);
  if (!given.is_none() && !is_dict) applyFile(config, pathOf(given, "config"));
  if (!mode.is_none()) applyMode(config, nameOf(mode));
  if (is_dict) applyDict(config, py::reinterpret_borrow<py::dict>(given));
  return config;
}

}  // namespace pf

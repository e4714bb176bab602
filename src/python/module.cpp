// SPDX-License-Identifier: BSD-3-Clause
// The compiled part of the Python package; python/posefusion has what users see of it.
#include "bindings.hpp"
#include "posefusion/core/error.hpp"

PYBIND11_MODULE(_core, module) {
  pybind11::register_exception<pf::InputError>(module, "InputError", PyExc_ValueError);
  pf::addRecording(module);
  pf::addSlam(module);
  pf::addEvaluation(module);
}

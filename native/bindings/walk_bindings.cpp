// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the walks, the searchlight and the windows of maps.
#include <pybind11/pybind11.h>

#include "bindings.hpp"

void lamina::bind_walk_parts(PyObject* object) {
  auto module = pybind11::reinterpret_borrow<pybind11::module_>(object);
  bind_walks(module);
  bind_scattering(module);
  bind_lateral(module);
  bind_lateral_walks(module);
  bind_maps(module);
}

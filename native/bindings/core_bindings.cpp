// SPDX-License-Identifier: GPL-3.0-or-later
// The contents of the Python module lamina._core.
#include <pybind11/pybind11.h>

#include "bindings.hpp"

PYBIND11_MODULE(core_bindings, module) {
  module.attr("__version__") = LAMINA_VERSION;
  lamina::bind_threads(module);
  lamina::bind_phase(module);
  lamina::bind_stack(module);
  lamina::bind_solver(module);
  lamina::bind_oriented(module);
  lamina::bind_fit(module);
  lamina::bind_walk_parts(module.ptr());
}

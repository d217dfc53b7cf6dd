// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module lamina._core.
#include <pybind11/pybind11.h>

#include "bindings.hpp"
#include "processor.hpp"

PYBIND11_MODULE(_core, module) {
  lamina::require_processor();
  module.attr("__version__") = LAMINA_VERSION;
  lamina::bind_threads(module);
  lamina::bind_phase(module);
  lamina::bind_stack(module);
  lamina::bind_solver(module);
  lamina::bind_fit(module);
  lamina::bind_walks(module);
  lamina::bind_scattering(module);
  lamina::bind_lateral(module);
  lamina::bind_lateral_walks(module);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The one file compiled for any processor of the architecture: it refuses the others in words before
// code for newer ones can run.
#include <pybind11/pybind11.h>

#include "bindings.hpp"

namespace {

bool processor_suffices() {
#if defined(__x86_64__) && defined(LAMINA_X86_64_V3)
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
#else
  return true;
#endif
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  if (!processor_suffices()) {
    throw pybind11::import_error("Lamina's compiled core needs a processor with AVX2 and FMA");
  }
  lamina::bind_threads(module);
  lamina::bind_phase(module);
  lamina::bind_solver(module);
  lamina::bind_fit(module);
  lamina::bind_walks(module);
  lamina::bind_scattering(module);
}

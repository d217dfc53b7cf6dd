// SPDX-License-Identifier: GPL-3.0-or-later
// Only for files that are compiled for any processor of the architecture: they refuse the others in words before
// code for newer ones can run.
#pragma once
#include <pybind11/pybind11.h>

namespace lamina {

/// Throws ImportError on a processor that this was not compiled for.
inline void require_processor() {
#if defined(__x86_64__) && defined(LAMINA_X86_64_V3)
  if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("fma") == 0) {
    throw pybind11::import_error("Lamina's compiled core needs a processor with AVX2 and FMA");
  }
#endif
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// The check of the processor at import. Include it only in files that are compiled for every processor of the
// architecture: they must report an unsupported processor before code for newer ones runs.
#pragma once
#include <pybind11/pybind11.h>

namespace lamina {

/// Throws ImportError on a processor that the core was not compiled for.
inline void require_processor() {
#if defined(__x86_64__) && defined(LAMINA_X86_64_V3)
  if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("fma") == 0) {
    throw pybind11::import_error("Lamina's compiled core needs a processor with AVX2 and FMA");
  }
#endif
}

}  // namespace lamina

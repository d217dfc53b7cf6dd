// SPDX-License-Identifier: GPL-3.0-or-later
// The check of the processor at import. Include it only in files that are compiled for every processor of the
// architecture: they must report an unsupported processor before code for newer ones runs.
#pragma once
#include <Python.h>

namespace lamina {

/// False, with ImportError set, on a processor that the core was not compiled for.
inline bool processor_suits() {
#if defined(__x86_64__) && defined(LAMINA_X86_64_V3)
  if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("fma") == 0) {
    PyErr_SetString(PyExc_ImportError, "Lamina's compiled core needs a processor with AVX2 and FMA");
    return false;
  }
#endif
  return true;
}

}  // namespace lamina

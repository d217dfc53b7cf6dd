// SPDX-License-Identifier: GPL-3.0-or-later
// The check of the processor at import. Include it only in files that are compiled for every processor of the
// architecture: they must report an unsupported processor before code for newer ones runs.
#pragma once
#include <Python.h>

#if defined(__x86_64__) && defined(LAMINA_X86_64_V3)
#include <cpuid.h>
#endif

namespace lamina {

#if defined(__x86_64__) && defined(LAMINA_X86_64_V3)
/// True if the processor has AVX2 and FMA, and the operating system keeps the wide registers (Intel SDM, volume 1,
/// 14.3 and 14.7.1). The compilers' __builtin_cpu_supports answers 0 on Windows when zig links the module.
inline bool has_avx2_and_fma() {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  if (__get_cpuid_count(1, 0, &a, &b, &c, &d) == 0 || (c & bit_FMA) == 0 || (c & bit_OSXSAVE) == 0) {
    return false;
  }
  unsigned kept = 0;
  unsigned upper = 0;
  __asm__ volatile("xgetbv" : "=a"(kept), "=d"(upper) : "c"(0));
  constexpr unsigned kXmmAndYmm = 6;
  return (kept & kXmmAndYmm) == kXmmAndYmm && __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (b & bit_AVX2) != 0;
}
#endif

/// False, with ImportError set, on a processor that the core was not compiled for.
inline bool processor_suits() {
#if defined(__x86_64__) && defined(LAMINA_X86_64_V3)
  if (!has_avx2_and_fma()) {
    PyErr_SetString(PyExc_ImportError, "Lamina's compiled core needs a processor with AVX2 and FMA");
    return false;
  }
#endif
  return true;
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Bessel functions of the first kind, J0 and J1, from the system's C library: POSIX has them as j0 and j1, Windows as
// _j0 and _j1. The C++ library of Clang lacks std::cyl_bessel_j.
#pragma once
#include <cmath>

namespace lamina {

#if defined(_WIN32)
inline double bessel_j0(double x) { return ::_j0(x); }
inline double bessel_j1(double x) { return ::_j1(x); }
#else
inline double bessel_j0(double x) { return ::j0(x); }
inline double bessel_j1(double x) { return ::j1(x); }
#endif

}  // namespace lamina

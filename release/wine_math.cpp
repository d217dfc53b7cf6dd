// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of complex numbers for Python's numpy under wine 8, whose C library has stubs in their place that end the
// program. release/wine_start.py makes each stub jump to its function here. They serve tests only.
#include <complex>

namespace {

// Windows passes 8 bytes in a register and 16 by reference: these are its own types for complex arguments.
struct Single {
  using Real = float;
  float real, imaginary;
};
struct Double {
  using Real = double;
  double real, imaginary;
};

template <class Parts>
std::complex<typename Parts::Real> joined(Parts z) {
  return {z.real, z.imaginary};
}

template <class Parts>
Parts parted(std::complex<typename Parts::Real> z) {
  return {z.real(), z.imag()};
}

}  // namespace

// The names are those of C, for float, double and long double, which is a double on Windows.
#define EXPORTED extern "C" __declspec(dllexport)
#define COMPLEX(name, function)                                                              \
  EXPORTED Single lamina_##name##f(Single z) { return parted<Single>(function(joined(z))); } \
  EXPORTED Double lamina_##name(Double z) { return parted<Double>(function(joined(z))); }    \
  EXPORTED Double lamina_##name##l(Double z) { return parted<Double>(function(joined(z))); }
#define REAL(name, function)                                                \
  EXPORTED float lamina_##name##f(Single z) { return function(joined(z)); } \
  EXPORTED double lamina_##name(Double z) { return function(joined(z)); }   \
  EXPORTED double lamina_##name##l(Double z) { return function(joined(z)); }

REAL(cabs, std::abs)
REAL(carg, std::arg)
REAL(cimag, std::imag)
REAL(creal, std::real)
COMPLEX(ccos, std::cos)
COMPLEX(ccosh, std::cosh)
COMPLEX(cexp, std::exp)
COMPLEX(csin, std::sin)
COMPLEX(csinh, std::sinh)
COMPLEX(ctan, std::tan)
COMPLEX(ctanh, std::tanh)

EXPORTED Single lamina_cpowf(Single z, Single power) { return parted<Single>(std::pow(joined(z), joined(power))); }
EXPORTED Double lamina_cpow(Double z, Double power) { return parted<Double>(std::pow(joined(z), joined(power))); }
EXPORTED Double lamina_cpowl(Double z, Double power) { return lamina_cpow(z, power); }

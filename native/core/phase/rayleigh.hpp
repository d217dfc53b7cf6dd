// SPDX-License-Identifier: GPL-3.0-or-later
// The phase function of Rayleigh.
#pragma once
#include <cmath>
#include <cstddef>

namespace lamina {

/// Rayleigh scattering of unpolarised light: 3/4 (1 + cos^2).
struct Rayleigh {
  static constexpr const char* kKind = "rayleigh";
  static constexpr std::size_t kParameters = 0;

  double evaluate(double cosine) const { return 0.75 * (1.0 + cosine * cosine); }
  double moment(int order) const { return order == 0 ? 1.0 : order == 2 ? 0.1 : 0.0; }
  double peak() const { return 0.0; }

  /// The root of cos^3 + 3 cos + 4 = 8 u.
  double sample(double u) const { return 2.0 * std::sinh(std::asinh(4.0 * u - 2.0) / 3.0); }
};

}  // namespace lamina

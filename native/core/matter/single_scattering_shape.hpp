// SPDX-License-Identifier: GPL-3.0-or-later
// The angular shape of single scattering by a homogeneous layer.
#pragma once
#include <algorithm>
#include <cmath>

namespace lamina {

/// (1 - exp(-tau (1/mu_o + 1/mu_i))) / (mu_o + mu_i): the angular shape of a layer's single scattering. The BRDF is
/// albedo p / (4 pi) times the shape (Chandrasekhar 1950). Divided by it, higher orders are smooth at grazing angles
/// too.
inline double single_reflection(double mu_o, double mu_i, double tau) {
  return -std::expm1(-tau * (1.0 / mu_o + 1.0 / mu_i)) / (mu_o + mu_i);
}

/// (exp(-tau / mu_o) - exp(-tau / mu_i)) / (mu_o - mu_i), with its limit at mu_o = mu_i.
inline double single_transmission(double mu_o, double mu_i, double tau) {
  const double lower = std::min(mu_o, mu_i);
  const double upper = std::max(mu_o, mu_i);
  const double direct = std::exp(-tau / upper);
  if (direct == 0.0) {
    return 0.0;
  }
  const double x = tau * (1.0 / lower - 1.0 / upper);
  const double mean = x < 1e-8 ? 1.0 - 0.5 * x : -std::expm1(-x) / x;
  return direct * mean * tau / (mu_o * mu_i);
}

/// The unscattered share of a beam; tau may be infinite.
inline double direct_transmission(double mu, double tau) { return std::exp(-tau / mu); }

}  // namespace lamina

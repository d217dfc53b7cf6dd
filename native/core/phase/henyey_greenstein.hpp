// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

namespace lamina {

/// Henyey and Greenstein, "Diffuse radiation in the galaxy" (1941); g in (-1, 1) is the mean cosine.
struct HenyeyGreenstein {
  double g = 0.0;

  double evaluate(double cosine) const {
    const double denominator = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (denominator * std::sqrt(denominator));
  }
  double moment(int order) const { return std::pow(g, order); }
  double peak() const { return std::abs(g); }
};

}  // namespace lamina

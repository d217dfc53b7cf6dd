// SPDX-License-Identifier: GPL-3.0-or-later
// The phase function of Henyey and Greenstein.
#pragma once
#include <cmath>
#include <cstddef>

namespace lamina {

/// Henyey and Greenstein, "Diffuse radiation in the galaxy" (1941); g in (-1, 1) is the mean cosine.
struct HenyeyGreenstein {
  static constexpr const char* kKind = "hg";
  static constexpr std::size_t kParameters = 1;

  double g = 0.0;

  double evaluate(double cosine) const {
    const double denominator = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (denominator * std::sqrt(denominator));
  }
  double moment(int order) const { return std::pow(g, order); }
  double peak() const { return std::abs(g); }

  /// With t = sqrt(1 + g^2 - 2 g cosine) and t = 1 + g - g d, the cumulative distribution is (1 - g) d / (2 t), which
  /// does not divide by g.
  double sample(double u) const {
    const double d = 2.0 * u * (1.0 + g) / (1.0 - g + 2.0 * u * g);
    return cosine_at(d);
  }

  /// The cosine for d in [0, 2].
  double cosine_at(double d) const { return d * (1.0 + g - 0.5 * g * d) - 1.0; }
};

}  // namespace lamina

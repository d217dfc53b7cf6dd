// SPDX-License-Identifier: GPL-3.0-or-later
// The phase function of Draine.
#pragma once
#include <cmath>
#include <cstddef>

#include "numeric/invert.hpp"
#include "phase/henyey_greenstein.hpp"
#include "phase/moment_decay.hpp"

namespace lamina {

/// Draine, "Scattering by interstellar dust grains" (2003), equation 8: the Henyey-Greenstein function times
/// 1 + alpha cos^2, normalised. g in (-1, 1), alpha >= 0. alpha = 0 is Henyey-Greenstein, alpha = 1 Cornette-Shanks,
/// g = 0 with alpha = 1 Rayleigh. The mean cosine is moment(1), not g.
class Draine {
 public:
  static constexpr const char* kKind = "draine";
  static constexpr std::size_t kParameters = 2;

  Draine(double g, double alpha)
      : lobe_{g}, alpha_(alpha), normalisation_(1.0 / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0)) {}

  double evaluate(double cosine) const {
    return normalisation_ * (1.0 + alpha_ * cosine * cosine) * lobe_.evaluate(cosine);
  }

  /// From x P_l = ((l + 1) P_{l+1} + l P_{l-1}) / (2 l + 1), twice: x^2 P_l is a sum of P_{l+2}, P_l, P_{l-2}.
  double moment(int order) const {
    const double l = order;
    const double here = std::pow(lobe_.g, order);
    const double above = here * lobe_.g * lobe_.g * (l + 1.0) * (l + 2.0) / ((2.0 * l + 1.0) * (2.0 * l + 3.0));
    const double same = here * (2.0 * l * (l + 1.0) - 1.0) / ((2.0 * l - 1.0) * (2.0 * l + 3.0));
    const double below =
        order < 2 ? 0.0 : std::pow(lobe_.g, order - 2) * l * (l - 1.0) / ((2.0 * l + 1.0) * (2.0 * l - 1.0));
    return normalisation_ * (here + alpha_ * (above + same + below));
  }

  double peak() const { return measured_peak(*this); }

  /// The cumulative distribution has a closed form in d of HenyeyGreenstein (a quartic without t) that does not divide
  /// by g. It is inverted by iteration from the Henyey-Greenstein solution.
  double sample(double u) const {
    const double g = lobe_.g;
    const double whole = 1.0 + g;
    const auto excess = [&](double d) -> ValueAndSlope {
      const double t = whole - g * d;
      const double side = 2.0 - d * whole;
      const double plain = 0.5 * (1.0 - g) * d / t;
      const double squared = 0.125 * (1.0 - g) * d * (side * side / t + whole * d * d / 3.0);
      return {normalisation_ * (plain + alpha_ * squared) - u, 0.5 * evaluate(lobe_.cosine_at(d)) * t};
    };
    const double guess = 2.0 * u * whole / (1.0 - g + 2.0 * u * g);
    return lobe_.cosine_at(invert_increasing(excess, 0.0, 2.0, guess));
  }

 private:
  HenyeyGreenstein lobe_;
  double alpha_;
  double normalisation_;
};

}  // namespace lamina

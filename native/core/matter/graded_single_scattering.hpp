// SPDX-License-Identifier: GPL-3.0-or-later
// Single scattering by a graded medium, integrated over depth in closed form.
#pragma once
#include <cmath>

#include "matter/graded_medium.hpp"

namespace lamina {

/// The means of exp(-d x) and of x exp(-d x) over x from 0 to 1.
struct ExponentialMoments {
  double mean;
  double first;

  explicit ExponentialMoments(double d) {
    constexpr double kSmall = 0.05;  // the series errs by less than d^6 / 5040 = 4e-12
    if (std::abs(d) < kSmall) {
      mean = 1.0 - d * (1.0 / 2.0 - d * (1.0 / 6.0 - d * (1.0 / 24.0 - d * (1.0 / 120.0 - d / 720.0))));
      first = 1.0 / 2.0 - d * (1.0 / 3.0 - d * (1.0 / 8.0 - d * (1.0 / 30.0 - d * (1.0 / 144.0 - d / 840.0))));
    } else {
      mean = -std::expm1(-d) / d;
      first = (mean - std::exp(-d)) / d;
    }
  }
};

/// Single scattering by a graded slab in closed form: 4 pi times the BRDF from above or, with `passes`, 4 pi times the
/// BTDF. `cosine` is the cosine of the scattering angle.
inline double scattered_once(const GradedMedium& medium, bool passes, double mu_o, double mu_i, double cosine) {
  const auto& knots = medium.knots();
  double sum = 0.0;
  // exp(-t / mu_i) on the way in, exp(-t / mu_o) or exp(-(tau - t) / mu_o) on the way out.
  const double rate = passes ? 1.0 / mu_i - 1.0 / mu_o : 1.0 / mu_i + 1.0 / mu_o;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double length = knots[k + 1].tau - knots[k].tau;
    const double left =
        passes ? std::exp(-knots[k].tau / mu_i - (medium.tau() - knots[k].tau) / mu_o) : std::exp(-knots[k].tau * rate);
    if (length == 0.0) {
      continue;
    }
    if (rate * length < -30.0) {
      // The exponential overflows downwards: integrate from the other end.
      const double kept = std::exp(-knots[k + 1].tau / mu_i - (medium.tau() - knots[k + 1].tau) / mu_o);
      const ExponentialMoments moments(-rate * length);
      sum += kept * length *
             ((moments.mean - moments.first) * knots[k + 1].albedo * knots[k + 1].phase.evaluate(cosine) +
              moments.first * knots[k].albedo * knots[k].phase.evaluate(cosine));
      continue;
    }
    const ExponentialMoments moments(rate * length);
    const double upper = moments.mean - moments.first;
    if (medium.keeps_phase(k)) {
      sum += left * length * (upper * knots[k].albedo + moments.first * knots[k + 1].albedo) *
             knots[k].phase.evaluate(cosine);
    } else {
      sum += left * length *
             (upper * knots[k].albedo * knots[k].phase.evaluate(cosine) +
              moments.first * knots[k + 1].albedo * knots[k + 1].phase.evaluate(cosine));
    }
  }
  return sum / (mu_o * mu_i);
}

}  // namespace lamina

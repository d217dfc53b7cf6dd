// SPDX-License-Identifier: GPL-3.0-or-later
// A homogeneous medium, and the same with its forward peak taken as unscattered light.
#pragma once
#include <vector>

#include "phase/phase.hpp"

namespace lamina {

/// A layer thinner than this is not there: between boundaries that reflect totally, the light that such a layer takes
/// out of a beam is lost in the rounding of 1 - exp(-2 tau / mu), and it is less than this anyway.
inline constexpr double kThinnestSeen = 1e-12;

/// A homogeneous scattering layer for one channel.
struct Medium {
  double albedo = 0.0;  ///< single scattering, sigma_s / sigma_t, in [0, 1]
  double tau = 0.0;     ///< optical thickness, [0, infinity]
  PhaseFunction phase;
};

/// A medium as seen by a discretisation that resolves `count` Legendre moments (delta-M, Wiscombe 1977):
/// the share f = chi_count of the scattering, which the moments cannot resolve, counts as unscattered.
struct TruncatedMedium {
  double albedo = 0.0;
  double tau = 0.0;
  double forward_share = 0.0;  ///< f
  std::vector<double> moments;

  TruncatedMedium(const Medium& medium, int count) : moments(static_cast<std::size_t>(count)) {
    const double f = medium.phase.moment(count);
    forward_share = f;
    for (int l = 0; l < count; ++l) {
      moments[static_cast<std::size_t>(l)] = (medium.phase.moment(l) - f) / (1.0 - f);
    }
    albedo = medium.albedo * (1.0 - f) / (1.0 - medium.albedo * f);
    tau = medium.tau < kThinnestSeen ? 0.0 : medium.tau * (1.0 - medium.albedo * f);
  }

  /// The albedo that scales the *untruncated* phase function in single scattering (TMS, Nakajima and
  /// Tanaka 1988): light in the truncated peak moves on unscattered, but where it leaves the beam it is
  /// seen under its true angle.
  double single_scattering_albedo() const { return albedo / (1.0 - forward_share); }
};

}  // namespace lamina

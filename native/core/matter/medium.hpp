// SPDX-License-Identifier: GPL-3.0-or-later
// A homogeneous medium, and its delta-M truncation.
#pragma once
#include <vector>

#include "phase/phase.hpp"

namespace lamina {

/// Layers thinner than this are ignored. They remove less light from a beam than this share. Between totally reflecting
/// boundaries such a share is lost in the rounding of 1 - exp(-2 tau / mu).
inline constexpr double kThinnestSeen = 1e-12;

/// A homogeneous scattering layer for one channel.
struct Medium {
  double albedo = 0.0;  ///< single scattering, sigma_s / sigma_t, in [0, 1]
  double tau = 0.0;     ///< optical thickness, [0, infinity]
  PhaseFunction phase;
};

/// The delta-M truncation of a medium to `count` Legendre moments (Wiscombe 1977): the unresolved share f = chi_count
/// of the scattering counts as unscattered light.
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

  /// The albedo for single scattering by the untruncated phase function (TMS, Nakajima and Tanaka 1988). The truncated
  /// peak counts as unscattered in the attenuation only.
  double single_scattering_albedo() const { return albedo / (1.0 - forward_share); }
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// A homogeneous medium, and its delta-M truncation.
#pragma once
#include <memory>
#include <vector>

#include "matter/flakes.hpp"
#include "phase/phase.hpp"

namespace lamina {

/// Layers thinner than this are ignored. They remove less light from a beam than this share. Between totally reflecting
/// boundaries such a share is lost in the rounding of 1 - exp(-2 tau / mu).
inline constexpr double kThinnestSeen = 1e-12;

/// A homogeneous scattering layer for one channel.
struct Medium {
  double albedo = 0.0;  ///< single scattering, sigma_s / sigma_t, in [0, 1]
  double tau = 0.0;     ///< optical thickness along the normal, [0, infinity]
  PhaseFunction phase;
  std::shared_ptr<const Flakes> flakes = {};  ///< what scatters in place of the phase function, or null
};

/// The delta-M truncation of a medium to `count` Legendre moments (Wiscombe 1977): the unresolved share f = chi_count
/// of the scattering counts as unscattered light. Flakes are not truncated, and have no moments.
struct TruncatedMedium {
  double albedo = 0.0;
  double tau = 0.0;
  double forward_share = 0.0;  ///< f
  std::vector<double> moments;
  std::shared_ptr<const Flakes> flakes;

  TruncatedMedium(const Medium& medium, int count) : flakes(medium.flakes) {
    tau = medium.tau < kThinnestSeen ? 0.0 : medium.tau;
    if (flakes) {
      albedo = medium.albedo;
      return;
    }
    moments.resize(static_cast<std::size_t>(count));
    const double f = medium.phase.moment(count);
    forward_share = f;
    for (int l = 0; l < count; ++l) {
      moments[static_cast<std::size_t>(l)] = (medium.phase.moment(l) - f) / (1.0 - f);
    }
    albedo = medium.albedo * (1.0 - f) / (1.0 - medium.albedo * f);
    tau *= 1.0 - medium.albedo * f;
  }

  /// The cosine with which the medium attenuates a ray, as exp(-tau / cosine): flakes show less area to oblique rays.
  double optical(double mu) const { return flakes ? mu / flakes->extinction(mu) : mu; }
  /// True if no light is absorbed.
  bool conserves() const { return albedo == 1.0 && !(flakes && flakes->absorb()); }

  /// The albedo for single scattering by the untruncated phase function (TMS, Nakajima and Tanaka 1988). The truncated
  /// peak counts as unscattered in the attenuation only.
  double single_scattering_albedo() const { return albedo / (1.0 - forward_share); }
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Flakes: small mirrors, or the matte sides of fibres, in a clear or absorbing binder, oriented about the layer's
// normal.
#pragma once
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <optional>

#include "matter/facet_optics.hpp"
#include "matter/filmed_flakes.hpp"

namespace lamina {

/// The flakes of a medium, small surfaces whose normals have the SGGX distribution about the layer's normal (Heitz et
/// al. 2015): mirrors, or matte ones, the sides of fibres. All extinctions are relative to that of a beam along the
/// layer's normal; of flakes that pass light, to that if they passed none.
struct Flakes {
  double alpha = 0.2;  ///< spread: the area that the flakes show along the layer, relative to that along the normal
  double share = 1.0;  ///< of the extinction along the normal; the rest is absorption by the binder
  /// The index of metal flakes, relative to the binder. Without it flakes reflect the same at all angles, and the
  /// albedo of the medium holds their reflectance.
  std::optional<std::complex<double>> metal = {};
  /// Of matte flakes: the share of the scattered light that leaves on their other side. Light leaves by Lambert's
  /// cosine law, and the albedo of the medium holds the share that is scattered.
  std::optional<double> translucency = {};
  std::shared_ptr<const FilmedFlakes> filmed = {};  ///< of mirrors with thin films, in place of `metal`

  /// The area of the flakes as seen along a ray of this cosine, relative to that seen along the normal.
  double area(double mu) const { return std::sqrt(alpha * alpha * (1.0 - mu * mu) + mu * mu); }
  /// The same of the area that takes light from a ray: what flakes pass goes straight on.
  double taking_area(double mu) const { return filmed ? filmed->taking_area(mu) : area(mu); }
  double extinction(double mu) const { return share * taking_area(mu) + 1.0 - share; }
  /// Density of the flakes' normals m by their cosine with the layer's normal: the integral of D |m.w| over half the
  /// sphere is area(w).
  double density(double cosine) const {
    const double stretched = alpha * alpha * cosine * cosine + 1.0 - cosine * cosine;
    return alpha * alpha / (std::numbers::pi * stretched * stretched);
  }
  /// What a flake reflects of a ray of this cosine with its normal, without the factor in the albedo.
  double reflectance(double cosine) const {
    return filmed ? filmed->reflectance(cosine) : metal ? conductor_fresnel(cosine, *metal) : 1.0;
  }
  /// What a flake does not pass of such a ray.
  double taken(double cosine) const { return filmed ? filmed->taken(cosine) : 1.0; }
  /// True if flakes absorb light, beside the factor in the albedo.
  bool absorb() const { return metal || (filmed && !filmed->conserves()); }
};

}  // namespace lamina

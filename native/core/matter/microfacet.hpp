// SPDX-License-Identifier: GPL-3.0-or-later
// Microfacet distributions of rough boundaries, masking, and single scattering by the facets.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <functional>

#include "matter/facet_optics.hpp"

namespace lamina {

/// The distribution of the facets of a rough boundary, and their masking. With `alpha_v` facets are anisotropic: of
/// width `alpha` along the tangent, which lies at `angle` from the x axis, and of width `alpha_v` across. All functions
/// of a cosine alone are those of isotropic facets.
struct Facets {
  enum class Distribution { kGgx, kBeckmann };
  double alpha = 0.1;  ///< width, (0, 1]
  Distribution distribution = Distribution::kGgx;
  /// Smith's masking for the two directions: height-correlated (Heitz 2014), or their product.
  bool correlated = true;
  /// Adds the energy that single scattering loses to masking: see passed(), RoughSurface and FacetScatter.
  bool compensate = true;
  double alpha_v = 0.0;  ///< width across the tangent, (0, 1]; 0: as alpha
  double angle = 0.0;    ///< azimuth of the tangent, in radians
  /// Reflected light is turned by half a turn about the mean normal, back to where it came from. Energy and reciprocity
  /// stay, and the azimuth orders of the reflection have alternating signs. Opaque isotropic facets only.
  bool retro = false;

  /// The factor of the horizontal part of reflected light: -1 for half a turn.
  double turn() const { return retro ? -1.0 : 1.0; }
  bool is_oriented() const { return alpha_v > 0.0 && alpha_v != alpha; }
  /// The width across the tangent.
  double across() const { return alpha_v > 0.0 ? alpha_v : alpha; }
  /// The same facets with the surface turned about its normal.
  Facets turned(double by) const {
    Facets other = *this;
    other.angle += by;
    return other;
  }
  /// Density of the facet normal (x, y, z), of length 1, z > 0; anisotropic too (Heitz 2014).
  double density(double x, double y, double z) const;
  /// Smith's Lambda of the direction (x, y, z), of length 1, z > 0; anisotropic too.
  double lambda(double x, double y, double z) const;

  /// Density of facet normals with cosine h to the mean normal; int D h dw = 1.
  Eigen::ArrayXd density(const Eigen::ArrayXd& h) const;
  /// Density for one cosine.
  double density(double h) const;
  /// Smith's Lambda.
  double lambda(double mu) const;
  double masking(double mu_o, double mu_i) const;
  double passing(double mu_o, double mu_i) const { return passed(lambda(mu_o), lambda(mu_i)); }
  /// Masking from Lambda at both directions.
  double masked(double lambda_o, double lambda_i) const {
    return correlated ? 1.0 / (1.0 + lambda_o + lambda_i) : 1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i));
  }
  /// Masking of refracted light. With compensation, refracted light that meets further facets passes through them
  /// without a turn: the smaller of Smith's maskings for one direction remains. Between equal indices, the light that
  /// arrives is then the light that leaves. The law is symmetric, and nothing is gained.
  double passed(double lambda_o, double lambda_i) const {
    return compensate ? 1.0 / (1.0 + std::max(lambda_o, lambda_i)) : masked(lambda_o, lambda_i);
  }
};

/// The BRDF of single reflection by facets, both directions in the medium where the light is. At all azimuths,
/// `cosines` = cos(dphi), 1 forward.
Eigen::ArrayXd facet_reflection(const Facets& facets, const FacetOptics& optics, double mu_o, double mu_i,
                                const Eigen::ArrayXd& cosines);

/// The BRDF of single reflection by opaque facets with a reflectance by the cosine between ray and facet.
Eigen::ArrayXd opaque_reflection(const Facets& facets, const std::function<double(double)>& reflectance, double mu_o,
                                 double mu_i, const Eigen::ArrayXd& cosines);

/// Single transmission between two media: the BTDF divided by the square of the index beyond, which is the same in both
/// senses (Walter et al. 2007, eq. 21).
Eigen::ArrayXd facet_transmission(const Facets& facets, const FacetOptics& optics, double mu, double mu_beyond,
                                  const Eigen::ArrayXd& cosines);

/// Directions on one side of a boundary, by their azimuths from one fixed direction.
struct FacetPairs {
  Eigen::ArrayXd mu;        ///< cosines, in (0, 1]
  Eigen::ArrayXXd cosines;  ///< cos(dphi), 1 forward: [direction, azimuth]
};

/// The functions above between the direction of cosine `mu` and all pairs: [direction, azimuth]. In a transmission the
/// pairs lie beyond.
Eigen::ArrayXXd facet_reflection(const Facets& facets, const FacetOptics& optics, double mu, const FacetPairs& pairs);
Eigen::ArrayXXd opaque_reflection(const Facets& facets, const std::function<double(double)>& reflectance, double mu,
                                  const FacetPairs& pairs);
Eigen::ArrayXXd facet_transmission(const Facets& facets, const FacetOptics& optics, double mu, const FacetPairs& pairs);

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Facet distributions of rough boundaries and their shadowing.
#pragma once
#include <Eigen/Core>
#include <complex>

namespace lamina {

/// How the facets of a rough boundary are distributed and shadow each other.
struct Facets {
  enum class Distribution { kGgx, kBeckmann };
  double alpha = 0.1;  ///< width, (0, 1]
  Distribution distribution = Distribution::kGgx;
  /// Smith's masking for the two directions: height-correlated (Heitz 2014), or their product.
  bool correlated = true;

  /// Density of facet normals with cosine h to the mean normal; int D h dw = 1.
  Eigen::ArrayXd density(const Eigen::ArrayXd& h) const;
  /// Density for one cosine.
  double density(double h) const;
  /// Smith's Lambda.
  double lambda(double mu) const;
  double masking(double mu_o, double mu_i) const;
  /// The same for Lambda known at both directions.
  double masked(double lambda_o, double lambda_i) const {
    return correlated ? 1.0 / (1.0 + lambda_o + lambda_i) : 1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i));
  }
};

/// Single reflection by dielectric facets between two media, both directions in the medium of index
/// `ior` with `beyond` on the other side; BRDF at all azimuths, `cosines` = cos(dphi), 1 forward.
Eigen::ArrayXd dielectric_reflection(const Facets& facets, double ior, double beyond, double mu_o, double mu_i,
                                     const Eigen::ArrayXd& cosines);

/// The same by a conductor of relative complex index `ratio` = (n + ik) / ior.
Eigen::ArrayXd conductor_reflection(const Facets& facets, std::complex<double> ratio, double mu_o, double mu_i,
                                    const Eigen::ArrayXd& cosines);

/// Fresnel's reflectance of a smooth conductor, and its mean over uniform diffuse light.
double conductor_fresnel(double mu, std::complex<double> ratio);
double mean_conductor_fresnel(std::complex<double> ratio);

/// Single transmission between two media: the BTDF from above to below divided by the square of the index
/// below, which makes it the same in both senses (Walter et al. 2007, eq. 21).
Eigen::ArrayXd dielectric_transmission(const Facets& facets, double ior_above, double ior_below, double mu_above,
                                       double mu_below, const Eigen::ArrayXd& cosines);

/// Directions on one side of a boundary against one fixed direction, at azimuths from it.
struct FacetPairs {
  Eigen::ArrayXd mu;        ///< cosines, in (0, 1]
  Eigen::ArrayXXd cosines;  ///< cos(dphi), 1 forward: [direction, azimuth]
};

/// The functions above between the direction of cosine `mu` and all pairs: [direction, azimuth]. In a transmission
/// `mu` lies in the medium of index `ior`, and the pairs in that of index `beyond`.
Eigen::ArrayXXd dielectric_reflection(const Facets& facets, double ior, double beyond, double mu,
                                      const FacetPairs& pairs);
Eigen::ArrayXXd conductor_reflection(const Facets& facets, std::complex<double> ratio, double mu,
                                     const FacetPairs& pairs);
Eigen::ArrayXXd dielectric_transmission(const Facets& facets, double ior, double beyond, double mu,
                                        const FacetPairs& pairs);

}  // namespace lamina

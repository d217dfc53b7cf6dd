// SPDX-License-Identifier: GPL-3.0-or-later
// Light from one direction, scattered once by the facets of an anisotropic boundary, as a bundle of rays.
#pragma once
#include <vector>

#include "matter/facet_optics.hpp"
#include "matter/microfacet.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {

/// A direction of travel, up or down: its horizontal part and the cosine with the normal, positive.
struct Heading {
  double x = 0.0;
  double y = 0.0;
  double mu = 1.0;

  /// Along the azimuth with this cosine and sine.
  static Heading of(double mu, double cosine, double sine);
};

/// Rays that leave a boundary, as shares of the incident flux.
struct RayList {
  std::vector<double> share;
  std::vector<Heading> ray;

  void add(double flux, const Heading& heading) {
    share.push_back(flux);
    ray.push_back(heading);
  }
};

/// Cosines on either side of a boundary at which functions of the scattered light are not smooth.
struct FacetEnds {
  std::vector<double> here;
  std::vector<double> beyond;
};

/// A quadrature over the facets that a ray sees. Slopes are scaled by the widths, so that facets of any width are those
/// of width 1 seen from another direction. Facets lie on circles, which are divided where the scattered light meets one
/// of the ends, and where total reflection begins.
class FacetBundle {
 public:
  /// `fineness`: number of circles, at least 3; twice as many facets lie on each.
  FacetBundle(const Facets& facets, int fineness);

  /// The rays of light that travels along `in`; returns the share that facets do not hide. A metal's share is that of
  /// facets that reflect everything. Replaces the contents of both lists.
  double scatter(const Heading& in, const FacetOptics& optics, const FacetEnds& ends, RayList& reflected,
                 RayList& transmitted) const;

 private:
  Facets facets_;
  int circles_;
  std::vector<Quadrature> panels_;  // by number of facets
};

/// Single scattering in closed form: radiance along `out` divided by the square of the index there, for unit irradiance
/// along `in`. `beyond`: `out` leaves on the other side than the light comes from.
double facet_value(const Facets& facets, const FacetOptics& optics, const Heading& in, const Heading& out, bool beyond);

}  // namespace lamina

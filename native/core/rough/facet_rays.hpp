// SPDX-License-Identifier: GPL-3.0-or-later
// Rays scattered by the facets of a rough boundary, a quadrature of each lobe.
#pragma once
#include <functional>
#include <vector>

#include "matter/base.hpp"

namespace lamina {

/// Rays that leave a boundary: shares of the incident flux, cosines with the normal, and cosines of the azimuth (1 is
/// forward).
struct Rays {
  std::vector<double> share;
  std::vector<double> mu;
  std::vector<double> azimuth;

  void add(double flux, double cosine, double x, double y);
};

/// Scatters light from one direction once at the facets of a boundary. The rays are a quadrature over facet normals,
/// weighted by the density of normals. The cost therefore hardly depends on the width of the lobes, and reflected and
/// transmitted rays share the energy of each facet.
///
/// The quadrature runs over circles of normals about the mean normal. On a circle, the reflectance and the outgoing
/// cosines depend only on the angle between ray and facet. Circles, and the range of circles, are therefore divided
/// where a facet turns away from the ray, where a ray would leave on the wrong side, and where total reflection begins.
class FacetRays {
 public:
  /// The functions to be integrated over the rays: piecewise polynomials of `degree` in the azimuth and in the cosine.
  /// The pieces end at the cosines `here` on the incident side and `beyond` on the other side; both lists start with 0.
  struct Pieces {
    int degree;
    std::vector<double> here;
    std::vector<double> beyond;
    double density = 1.0;  ///< factor on the number of points per lobe
  };

  /// Facets between dielectrics.
  FacetRays(const Facets& facets, FacetOptics optics, Pieces pieces);
  /// Opaque facets with a reflectance by cosine.
  FacetRays(const Facets& facets, std::function<double(double)> reflectance, Pieces pieces);
  /// The facets of a base below a medium of index `ior_above`. Of a measured base, rays about the normals of its
  /// facets.
  FacetRays(const Base& base, double ior_above, Pieces pieces);

  /// Computes the rays for light of cosine `mu` in (0, 1] with the normal. Replaces the contents of both lists.
  void scatter(double mu, Rays& reflected, Rays& transmitted) const;

 private:
  /// The direction of the light, and Smith's Lambda there.
  struct Incident {
    double mu;
    double across;
    double lambda;
  };
  /// Cosine and sine of the angle between a facet's normal and the mean normal.
  struct Tilt {
    double upright;
    double flat;
  };
  void circle(const Incident& in, double angle, double weight, Rays& reflected, Rays& transmitted) const;
  void facet(const Incident& in, const Tilt& tilt, double azimuth, double weight, Rays& reflected,
             Rays& transmitted) const;
  std::vector<double> divisions(double mu) const;

  Facets facets_;
  FacetOptics optics_;
  double ratio_ = 0.0;                         // of indices, beyond / here; 0 if the facets are opaque
  double critical_ = 0.0;                      // cosine with a facet where total reflection ends; 0 if there is none
  std::function<double(double)> reflectance_;  // empty for dielectrics
  std::shared_ptr<const MeasuredReflection> measured_;  // null for facets
  double steepest_;                                     // angle beyond which there are no facets
  Pieces pieces_;
};

}  // namespace lamina

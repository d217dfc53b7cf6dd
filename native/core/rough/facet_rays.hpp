// SPDX-License-Identifier: GPL-3.0-or-later
// Rays that the facets of a rough boundary scatter, as a quadrature of each lobe.
#pragma once
#include <functional>
#include <vector>

#include "matter/microfacet.hpp"

namespace lamina {

/// Rays that leave a boundary: shares of the incident flux, cosines with the normal, cosines of the azimuth
/// (1 forward).
struct Rays {
  std::vector<double> share;
  std::vector<double> mu;
  std::vector<double> azimuth;

  void add(double flux, double cosine, double x, double y);
};

/// Light of one direction after one meeting with the facets of a boundary, as rays: a quadrature over the
/// facets' normals, weighted by how many facets face that way, so that its cost hardly depends on how narrow
/// the lobes are and reflection and transmission share one energy.
///
/// The normals lie on circles about the mean normal. On a circle all that happens depends on the angle
/// between ray and facet alone, so the circle, and the set of circles, can be divided where a facet turns
/// away, where the ray would leave on the wrong side, and where total reflection begins.
class FacetRays {
 public:
  /// What the rays will be integrated with: polynomials of that degree in the azimuth and in the cosine, other
  /// ones between any two of these ends, cosines on the light's side and beyond, which start with 0.
  struct Pieces {
    int degree;
    std::vector<double> here;
    std::vector<double> beyond;
    double density = 1.0;  ///< multiplies the points of a lobe
  };

  /// Between dielectrics; `ratio`: index on the other side by that on the ray's.
  FacetRays(const Facets& facets, double ratio, Pieces pieces);
  /// Facets through which nothing passes, of that reflectance by cosine.
  FacetRays(const Facets& facets, std::function<double(double)> reflectance, Pieces pieces);

  /// Rays for light whose cosine with the normal is `mu`, in (0, 1]; those before are dropped.
  void scatter(double mu, Rays& reflected, Rays& transmitted) const;

 private:
  /// The light's direction, and Smith's Lambda there.
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
  double ratio_ = 0.0;                         // 0: nothing passes
  double critical_ = 0.0;                      // cosine at a facet where total reflection ends, 0: there is none
  std::function<double(double)> reflectance_;  // empty for dielectrics
  double steepest_;                            // angle beyond which there are no facets
  Pieces pieces_;
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// The boundary of a solid in air: none, smooth, or rough.
#pragma once
#include <memory>

#include "matter/microfacet.hpp"
#include "walks/facet_scatter.hpp"
#include "walks/sphere.hpp"

namespace lamina {

/// What light meets where it enters or leaves a solid. Directions are those of travel; normals point outwards.
class SurfaceBoundary {
 public:
  /// `ior`: index of the solid, 1: no boundary. Without `facets` the boundary is smooth.
  SurfaceBoundary(double ior, const Facets* facets);

  enum class Kind { kMatched, kSmooth, kRough };
  Kind kind() const { return kind_; }

  struct Outcome {
    Ray direction;
    double weight;  ///< share of the power; 0 if the light is lost
  };
  /// Reflection or refraction, chosen at random, of light from either side.
  Outcome meet(const Ray& in, const Ray& normal, Rng& rng) const;

  /// Only refraction of light from outside, with the share that enters as weight. For boundaries that are not rough.
  Outcome enter(const Ray& in, const Ray& normal) const;

  /// Of a rough boundary: the power that leaves per solid angle along `out`, outside, of light along `in` from inside.
  double leaving(const Ray& in, const Ray& out, const Ray& normal) const;

 private:
  Kind kind_;
  double ior_;
  std::shared_ptr<const FacetScatter> rough_;
};

}  // namespace lamina

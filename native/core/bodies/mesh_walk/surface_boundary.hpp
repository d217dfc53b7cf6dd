// SPDX-License-Identifier: GPL-3.0-or-later
// The boundary of a solid in air: none, smooth, or rough.
#pragma once
#include <memory>

#include "events/facet_scatter.hpp"
#include "events/sphere.hpp"
#include "matter/microfacet.hpp"

namespace lamina {

/// The boundary where light enters or leaves a solid. Directions are directions of travel; normals point outwards.
class SurfaceBoundary {
 public:
  /// `ior`: refractive index of the solid; 1: matched, no boundary. If `facets` is null, the boundary is smooth.
  SurfaceBoundary(double ior, const Facets* facets);

  enum class Kind { kMatched, kSmooth, kRough };
  Kind kind() const { return kind_; }

  struct Outcome {
    Ray direction;
    double weight;  ///< share of the power; 0 if the light is lost
  };
  /// Samples reflection or refraction of light from either side.
  Outcome meet(const Ray& in, const Ray& normal, Rng& rng) const;

  /// Refracts light from outside; the weight is the transmitted share. Not for rough boundaries.
  Outcome enter(const Ray& in, const Ray& normal) const;

  /// For a rough boundary: the share of the power of light along `in`, from either side, that leaves along `out`,
  /// outside, per solid angle.
  double leaving(const Ray& in, const Ray& out, const Ray& normal) const;

  /// For a smooth boundary: the direction outside to which light along `in`, from either side, is refracted or
  /// reflected, and its share of the power.
  Outcome leaving(const Ray& in, const Ray& normal) const;

  /// The direction of travel inside of light from `towards`, outside, refracted by a smooth face with this normal.
  Ray inside(const Ray& towards, const Ray& normal) const { return enter(-towards, normal).direction; }
  /// The approximate angle, in radians, over which the facets spread light that is refracted into the solid.
  double blur() const;

 private:
  Kind kind_;
  double ior_;
  double alpha_;
  std::shared_ptr<const FacetScatter> rough_;
};

}  // namespace lamina

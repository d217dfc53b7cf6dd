// SPDX-License-Identifier: GPL-3.0-or-later
// Scattering of single rays by a surface.
#pragma once
#include "events/sphere.hpp"
#include "numeric/rng.hpp"

namespace lamina {

/// A surface that scatters light into lobes, for walks. Rays are directions of travel, z up.
class ScatteringSurface {
 public:
  /// An outgoing ray and its share of the incoming power; 0 if the light is lost.
  struct Outcome {
    Ray ray;
    double weight;
  };

  ScatteringSurface() = default;
  ScatteringSurface(const ScatteringSurface&) = default;
  ScatteringSurface& operator=(const ScatteringSurface&) = default;
  virtual ~ScatteringSurface() = default;

  /// The width of the narrowest lobe, as that of facets.
  virtual double alpha() const = 0;
  /// The radiance along `out`, divided by the square of the index there, for unit irradiance along `in`.
  virtual double value(const Ray& in, const Ray& out) const = 0;
  virtual Outcome sample(const Ray& in, Rng& rng) const = 0;
  /// As `value` and `sample` for the narrow part of the lobes. Only reflected or only refracted light is sampled.
  virtual double value_once(const Ray& in, const Ray& out) const = 0;
  virtual Outcome sample_once(const Ray& in, bool reflects, Rng& rng) const = 0;
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Directions from inside a solid in which the light of a lamp arrives through the boundary.
#pragma once
#include <optional>

#include "mesh_walk/lamp.hpp"
#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// A density of directions at a scattering, concentrated about the direction from which the refracted light of one
/// point of a lamp arrives. The direction is a guess from the normals of nearby faces. A wrong guess costs noise, not
/// bias, because the density is combined with the phase function by the balance heuristic (Veach and Guibas 1995).
class AimedLight {
 public:
  /// Nothing if the lamp's light would reach the position through more than a few mean free paths, or not at all. The
  /// result depends on the arguments only.
  static std::optional<AimedLight> at(const Scattering& scattering, const Lamp& lamp, const LampPoint& point,
                                      const MeshWalk& walk, WalkCounts& counts);

  Ray sample(Rng& rng) const;
  /// Per solid angle.
  double density(const Ray& direction) const;

 private:
  AimedLight(const Ray& middle, double narrow, double wide) : middle_(middle), narrow_(narrow), wide_(wide) {}

  Ray middle_;
  double narrow_;  ///< g of a lobe with the shape of Henyey and Greenstein's phase function
  double wide_;    ///< g of a wider lobe
};

}  // namespace lamina

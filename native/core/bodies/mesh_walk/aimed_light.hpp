// SPDX-License-Identifier: GPL-3.0-or-later
// Directions from inside a solid in which the light of a lamp arrives through the boundary.
#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "mesh_walk/lamp.hpp"
#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// A density of directions at a scattering, concentrated about the directions from which the refracted light of one
/// point of a lamp may arrive. The directions are guesses from the normals of nearby faces. A wrong guess costs noise,
/// not bias, because the density is combined with the phase function by the balance heuristic (Veach and Guibas 1995).
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
  static constexpr int kMostGuesses = 4;

  AimedLight(double narrow, double wide) : narrow_(narrow), wide_(wide) {}
  std::size_t last() const { return static_cast<std::size_t>(guesses_ - 1); }

  std::array<Ray, kMostGuesses> middles_;  ///< of the narrow lobes; the last is that of the wide lobe
  int guesses_ = 0;
  double narrow_;  ///< g of lobes with the shape of Henyey and Greenstein's phase function
  double wide_;    ///< g of a wider lobe
};

}  // namespace lamina

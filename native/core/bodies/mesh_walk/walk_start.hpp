// SPDX-License-Identifier: GPL-3.0-or-later
// Where a walk starts: the face there, and whether light can enter.
#pragma once
#include <cstdint>
#include <optional>

#include "mesh_walk/solid.hpp"

namespace lamina {

struct StartFace {
  Place place;
  Ray normal;
  std::uint32_t face;
  bool is_opaque;
};
/// The face at a place on or very near the surface, seen from outside along a normal that may be a shading normal.
std::optional<StartFace> start_face(const Solid& solid, const Place& place, const Ray& normal);

/// True if another part of the mesh contains the place.
bool is_buried(const Solid& solid, const Place& place, const Ray& normal);

/// Whether light can enter at a start of walks. kBuried: another part of the mesh contains the start. kInward: the
/// normal points against those of all faces around. kOpaque: the face there is opaque.
enum class Exposure { kOpen, kBuried, kInward, kOpaque };
Exposure exposure(const Solid& solid, const Place& place, const Ray& normal);

}  // namespace lamina

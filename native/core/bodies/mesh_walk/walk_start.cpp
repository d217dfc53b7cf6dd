// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/walk_start.hpp"

#include "mesh_walk/surface_search.hpp"

namespace lamina {

namespace {

// Largest distance between a start and the surface, relative to the solid's size.
constexpr double kReach = 1e-4;
// Shading normals may point slightly away from a face at the edge of a thin part.
constexpr double kTurned = -0.5;

}  // namespace

std::optional<StartFace> start_face(const Solid& solid, const Place& place, const Ray& normal) {
  const double reach = kReach * solid.size();
  const auto found = solid.first_crossing(place.moved(normal, reach), -normal, 0.0, 2.0 * reach);
  if (!found) {
    return std::nullopt;
  }
  return StartFace{place.moved(normal, reach - found->distance), found->normal, found->face, found->is_opaque};
}

bool is_buried(const Solid& solid, const Place& place, const Ray& normal) {
  const Place outside = place.moved(normal, kReach * solid.size());
  // A ray that leaves a part without entering it starts inside that part.
  return SurfaceSearch(solid, outside, normal, 0, false).shells_on_the_way() < 0;
}

Exposure exposure(const Solid& solid, const Place& place, const Ray& normal) {
  if (solid.largest_cosine(place, normal, kReach * solid.size()) < kTurned) {
    return Exposure::kInward;
  }
  if (is_buried(solid, place, normal)) {
    return Exposure::kBuried;
  }
  const auto face = start_face(solid, place, normal);
  return face && face->is_opaque ? Exposure::kOpaque : Exposure::kOpen;
}

}  // namespace lamina

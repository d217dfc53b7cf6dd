// SPDX-License-Identifier: GPL-3.0-or-later
// A closed mesh: intersections with its surface, and distances to the surface.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "interior/place.hpp"
#include "mesh/mesh_scene.hpp"
#include "mesh_walk/flight_ray.hpp"
#include "mesh_walk/surface_distance.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// The intersection of a ray and the surface: the distance in mm, the outward normal, the number of the face, and
/// whether the face absorbs all light that meets it, from either side.
struct Crossing {
  double distance;
  Ray normal;
  std::uint32_t face;
  bool is_opaque;
};

/// A closed mesh with outward normals; lengths in mm. Coordinates should lie around 0: single precision resolves the
/// surface to about 1e-7 of the largest one.
class Solid {
 public:
  /// `opaque`: which faces absorb all light that meets them; empty: none. Calls `go_on(fraction)` from time to time.
  /// Throws MeshScene::Stopped if `go_on` returns false.
  Solid(TrianglePart part, std::vector<bool> opaque, ThreadPool& pool, const std::function<bool(double)>& go_on);

  /// A lower bound in mm of the distance to the surface; 0 if no bound is known.
  double clearance(const Place& place) const { return distance_.clearance(place); }

  /// The distance from a position to the surface in mm, at most `within`.
  float distance(const float place[3], float within) const { return scene_.nearest_distance(place, within); }

  /// The largest cosine between a direction and the normals of the faces within a distance of a position; 1 without
  /// such faces.
  double largest_cosine(const Place& place, const Ray& direction, double within) const {
    const float at[3] = {static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z)};
    const float along[3] = {static_cast<float>(direction.x), static_cast<float>(direction.y),
                            static_cast<float>(direction.z)};
    return scene_.largest_cosine(at, along, static_cast<float>(within)).value_or(1.0F);
  }

  std::optional<Crossing> first_crossing(const Place& from, const Ray& direction, double nearest,
                                         double farthest) const {
    const auto hit = scene_.first_surface(flight_ray(from, direction, nearest, farthest));
    if (!hit) {
      return std::nullopt;
    }
    return Crossing{hit->distance, {hit->normal[0], hit->normal[1], hit->normal[2]}, hit->face, is_opaque(hit->face)};
  }

  std::size_t faces() const { return scene_.part(0).triangles.size() / 3; }
  bool is_opaque(std::size_t face) const { return !opaque_.empty() && opaque_[face]; }
  /// The corners of a face, counter-clockwise seen from outside.
  std::array<Place, 3> corners(std::size_t face) const {
    const TrianglePart& part = scene_.part(0);
    const auto corner = [&](std::size_t k) {
      const float* at = part.vertices.data() + std::size_t{3} * part.triangles[3 * face + k];
      return Place{at[0], at[1], at[2]};
    };
    return {corner(0), corner(1), corner(2)};
  }

  /// True if a position lies in the mesh's bounding box, with a margin for rounding.
  bool box_holds(const Place& place) const {
    const double margin = 1e-6 * size_;
    const std::array<double, 3> at = {place.x, place.y, place.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(at[axis] > low_[axis] - margin && at[axis] < high_[axis] + margin)) {
        return false;
      }
    }
    return true;
  }
  const std::array<double, 3>& low() const { return low_; }
  const std::array<double, 3>& high() const { return high_; }
  /// The diagonal of the mesh's bounding box in mm.
  double size() const { return size_; }
  std::size_t bytes() const { return scene_.bytes() + distance_.bytes(); }

 private:
  std::array<double, 3> low_;
  std::array<double, 3> high_;
  double size_;
  std::vector<bool> opaque_;
  MeshScene scene_;
  SurfaceDistance distance_;
};

}  // namespace lamina

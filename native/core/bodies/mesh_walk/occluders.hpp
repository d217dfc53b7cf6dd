// SPDX-License-Identifier: GPL-3.0-or-later
// Opaque things around a solid: they cast shadows on it, reflect light diffusely, and may shine.
#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "interior/channels.hpp"
#include "interior/place.hpp"
#include "mesh/mesh_scene.hpp"
#include "mesh_walk/flight_ray.hpp"

namespace lamina {

/// Triangles outside of a solid, in its coordinates. Both sides of a face reflect and shine.
class Occluders {
 public:
  /// The albedo of a face, and the radiance that it emits.
  struct Face {
    std::array<float, kChannels> albedo;
    std::array<float, kChannels> emission;
  };
  /// Where a ray meets a face: a position just above it, and the normal on the ray's side.
  struct Hit {
    Place place;
    Ray normal;
    const Face& face;
  };

  /// `faces`: one for each triangle. `size`: of the solid in mm; what is nearer than a small share of it does not
  /// count. Calls `go_on(fraction)` from time to time. Throws MeshScene::Stopped if `go_on` returns false.
  Occluders(TrianglePart part, std::vector<Face> faces, double size, unsigned threads,
            const std::function<bool(double)>& go_on)
      : faces_(std::move(faces)), nearest_(kNearest * size), scene_({std::move(part)}, threads, go_on) {}

  /// True if a face lies on the way from a position up to the distance `farthest`.
  bool block(const Place& from, const Ray& direction, double farthest) const {
    return nearest_ < farthest && scene_.occluded(flight_ray(from, direction, nearest_, farthest));
  }

  /// The first face on that way.
  std::optional<Hit> first(const Place& from, const Ray& direction, double farthest) const {
    const auto hit =
        nearest_ < farthest ? scene_.first_surface(flight_ray(from, direction, nearest_, farthest)) : std::nullopt;
    if (!hit) {
      return std::nullopt;
    }
    const Ray normal = {hit->normal[0], hit->normal[1], hit->normal[2]};
    const Ray facing = normal.dot(direction) < 0.0 ? normal : -normal;
    const Place place = from.moved(direction, hit->distance);
    const double rounding = kRounding * (std::abs(place.x) + std::abs(place.y) + std::abs(place.z) + hit->distance);
    return Hit{place.moved(facing, rounding), facing, faces_[hit->face]};
  }

 private:
  static constexpr double kNearest = 1e-4;   // relative to the solid's size
  static constexpr double kRounding = 4e-6;  // some tens of errors of single precision, relative to coordinates

  std::vector<Face> faces_;
  double nearest_;
  MeshScene scene_;
};

}  // namespace lamina

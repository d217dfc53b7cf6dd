// SPDX-License-Identifier: GPL-3.0-or-later
// Ray queries on triangles. Only mesh_scene.cpp includes Embree.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamina {

/// Triangles of one object: x y z of each vertex, and three indices of each triangle, all below the number of
/// vertices. MeshScene adds the four bytes of padding that Embree reads past the end.
struct TrianglePart {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
};

/// A ray along `direction`, of any length but 0, between `nearest` and `farthest`, in units of that length.
struct MeshRay {
  float origin[3];
  float direction[3];
  float nearest = 0.0F;
  float farthest;
};

/// The first face that a ray hits: its part (-1: no hit), and whether the ray hits its front, the side from which its
/// corners run counter-clockwise.
struct MeshHit {
  int part;
  bool front;
};

/// The intersection of a ray and a face: the distance along the ray in units of the direction's length, the unit normal
/// on the side from which the face's corners run counter-clockwise, and the number of the face in its part.
struct SurfaceHit {
  float distance;
  float normal[3];
  std::uint32_t face;
};

/// Several parts in one scene. Queries are thread-safe and watertight at shared edges, and do not depend on the number
/// of threads that built the scene.
class MeshScene {
 public:
  /// Builds on `threads` threads, which call `go_on(fraction)` from time to time. If `go_on` returns false, the build
  /// stops and throws Stopped. Throws std::runtime_error if Embree fails, for example for lack of memory.
  MeshScene(std::vector<TrianglePart> parts, unsigned threads, const std::function<bool(double)>& go_on);
  ~MeshScene();
  MeshScene(const MeshScene&) = delete;
  MeshScene& operator=(const MeshScene&) = delete;

  struct Stopped {};

  bool occluded(const MeshRay& ray) const;
  MeshHit first_hit(const MeshRay& ray) const;
  /// The first face that a ray hits, of any part.
  std::optional<SurfaceHit> first_surface(const MeshRay& ray) const;
  /// The distance from a position to the nearest face of any part, at most `within`.
  float nearest_distance(const float place[3], float within) const;
  /// The largest cosine between a unit vector and the normals of the faces within a distance of a position. Faces
  /// without area do not count.
  std::optional<float> largest_cosine(const float place[3], const float direction[3], float within) const;
  std::size_t parts() const { return parts_.size(); }
  const TrianglePart& part(std::size_t number) const { return parts_[number]; }
  /// Memory that Embree holds for the scene.
  std::size_t bytes() const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
  std::vector<TrianglePart> parts_;
};

/// An error message, or empty if Embree has the expected version and a test ray hits its triangle. Two copies of Embree
/// in one process can make rays miss silently.
std::string mesh_self_test();

}  // namespace lamina

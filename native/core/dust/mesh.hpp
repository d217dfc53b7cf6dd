// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles that rays meet. What lies behind it is Embree, which only mesh.cpp knows.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace lamina {

/// Triangles of one object: x y z of each vertex, and three indices of each triangle, all below the number of
/// vertices. The last four bytes of padding that Embree reads past the end are added by MeshScene.
struct TrianglePart {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
};

/// From `origin` along `direction`, of any length but 0, between `nearest` and `farthest` lengths of it.
struct MeshRay {
  float origin[3];
  float direction[3];
  float nearest = 0.0F;
  float farthest;
};

/// The first face that a ray meets: which part (-1: none), and whether it is met from its front, the side from
/// which its corners run counter-clockwise.
struct MeshHit {
  int part;
  bool front;
};

/// Parts in one scene, for rays from any number of threads at once. Rays cannot slip through between triangles
/// that share an edge, and a hit does not depend on the number of threads that built the scene.
class MeshScene {
 public:
  /// Builds on `threads` threads. `go_on(fraction)` is called now and then, from the threads that build; when it
  /// returns false the scene is not built and Stopped is thrown. Throws std::runtime_error when Embree fails, for
  /// want of memory for example.
  MeshScene(std::vector<TrianglePart> parts, unsigned threads, const std::function<bool(double)>& go_on);
  ~MeshScene();
  MeshScene(const MeshScene&) = delete;
  MeshScene& operator=(const MeshScene&) = delete;

  struct Stopped {};

  bool occluded(const MeshRay& ray) const;
  MeshHit first_hit(const MeshRay& ray) const;
  std::size_t parts() const { return parts_.size(); }
  /// What Embree holds for the scene.
  std::size_t bytes() const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
  std::vector<TrianglePart> parts_;
};

/// Empty when Embree is of the version that this was compiled for and a ray meets what it must meet; otherwise
/// what is wrong. Two copies of Embree in one process can make it silently blind.
std::string mesh_self_test();

}  // namespace lamina

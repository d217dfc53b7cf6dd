// SPDX-License-Identifier: GPL-3.0-or-later
// Opaque things around a solid: they cast shadows on it, reflect light diffusely, and may shine.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
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
  static constexpr unsigned kLinkings = 64;
  /// The linkings of light, by number: bit l of a set is linking l.
  using LinkingSet = std::uint64_t;
  static constexpr LinkingSet kAll = ~LinkingSet{0};
  static bool holds(LinkingSet set, unsigned linking) { return (set >> linking & 1U) != 0; }

  /// The albedo of a face, and the radiance that it emits.
  struct Face {
    std::array<float, kChannels> albedo;
    std::array<float, kChannels> emission;
  };
  /// Which light meets what. Of each face: the linkings whose light it takes, the linkings whose light lights it, and
  /// the linking of what it emits. `solid_lit`: the linkings whose light lights the solid.
  struct Links {
    std::vector<LinkingSet> shadows;
    std::vector<LinkingSet> lit;
    std::vector<std::uint8_t> emits;
    LinkingSet solid_lit = kAll;
  };
  /// Where a ray meets a face: a position just above it, the normal on the ray's side, the face, and the linkings that
  /// light it.
  struct Hit {
    Place place;
    Ray normal;
    const Face& face;
    LinkingSet lit;
  };
  using GoOn = std::function<bool(double)>;

  /// `faces`: one for each triangle. `size`: of the solid in mm; what is nearer than a small share of it does not
  /// count. `links`: by default all faces take, and are lit by, all light. Calls `go_on(fraction)` from time to time.
  /// Throws MeshScene::Stopped if `go_on` returns false.
  Occluders(TrianglePart part, std::vector<Face> faces, std::optional<Links> links, double size, unsigned threads,
            const GoOn& go_on);

  /// True if a face takes light of a linking on the way from a position up to the distance `farthest`.
  bool block(const Place& from, const Ray& direction, double farthest, unsigned linking) const {
    const MeshScene* scene = shadows_[linking];
    return scene != nullptr && nearest_ < farthest && scene->occluded(flight_ray(from, direction, nearest_, farthest));
  }

  /// The first face on that way.
  std::optional<Hit> first(const Place& from, const Ray& direction, double farthest) const;

  /// The radiance that faces emit and that arrives at `from` along that way, of the linkings in `lit`. `first`: the
  /// first face. Light that reaches such a way through another part of the solid does not count.
  Weights emitted(const Place& from, const Ray& direction, double farthest, const std::optional<Hit>& first,
                  LinkingSet lit) const;

  LinkingSet solid_lit() const { return links_ ? links_->solid_lit : kAll; }

 private:
  /// Some of the faces: their numbers, and a scene of them.
  struct Part {
    std::vector<std::uint32_t> faces;
    std::unique_ptr<MeshScene> scene;
  };
  /// The faces that emit light of a linking which not all faces take, and those that take it.
  struct Shining {
    unsigned linking;
    Part part;
  };

  void link(unsigned threads, const GoOn& go_on);
  Part part_of(std::vector<std::uint32_t> faces, unsigned threads, const GoOn& go_on) const;
  void add_shining(const Shining& shining, const Place& from, const Ray& direction, double farthest,
                   Weights& found) const;

  std::vector<Face> faces_;
  std::optional<Links> links_;
  double nearest_;
  MeshScene scene_;
  std::array<const MeshScene*, kLinkings> shadows_;  ///< what takes light of a linking; null: nothing
  std::vector<Part> parts_;                          ///< those of `shadows_` that do not hold all faces
  std::vector<Shining> shining_;
  LinkingSet passing_ = 0;  ///< the linkings of `shining_`
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/occluders.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamina {

namespace {

constexpr double kNearest = 1e-4;   // relative to the solid's size
constexpr double kRounding = 4e-6;  // some tens of errors of single precision, relative to coordinates

bool shines(const Occluders::Face& face) {
  return std::any_of(face.emission.begin(), face.emission.end(), [](float value) { return value > 0.0F; });
}

void add(const Occluders::Face& face, Weights& found) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    found[c] += static_cast<double>(face.emission[c]);
  }
}

}  // namespace

Occluders::Occluders(TrianglePart part, std::vector<Face> faces, std::optional<Links> links, double size,
                     unsigned threads, const GoOn& go_on)
    : faces_(std::move(faces)),
      links_(std::move(links)),
      nearest_(kNearest * size),
      scene_({std::move(part)}, threads, go_on) {
  shadows_.fill(&scene_);
  if (links_) {
    link(threads, go_on);
  }
}

std::optional<Occluders::Hit> Occluders::first(const Place& from, const Ray& direction, double farthest) const {
  const auto hit =
      nearest_ < farthest ? scene_.first_surface(flight_ray(from, direction, nearest_, farthest)) : std::nullopt;
  if (!hit) {
    return std::nullopt;
  }
  const Ray normal = {hit->normal[0], hit->normal[1], hit->normal[2]};
  const Ray facing = normal.dot(direction) < 0.0 ? normal : -normal;
  const Place place = from.moved(direction, hit->distance);
  const double rounding = kRounding * (std::abs(place.x) + std::abs(place.y) + std::abs(place.z) + hit->distance);
  return Hit{place.moved(facing, rounding), facing, faces_[hit->face], links_ ? links_->lit[hit->face] : kAll};
}

Weights Occluders::emitted(const Place& from, const Ray& direction, double farthest, const std::optional<Hit>& first,
                           LinkingSet lit) const {
  Weights found = {};
  if (first &&
      (!links_ || holds(lit & ~passing_, links_->emits[static_cast<std::size_t>(&first->face - &faces_[0])]))) {
    add(first->face, found);
  }
  for (const Shining& shining : shining_) {
    if (holds(lit, shining.linking)) {
      add_shining(shining, from, direction, farthest, found);
    }
  }
  return found;
}

/// Adds each shining face up to the first face that takes the light. What a face that takes it emits still counts.
void Occluders::add_shining(const Shining& shining, const Place& from, const Ray& direction, double farthest,
                            Weights& found) const {
  double near = nearest_;
  while (near < farthest) {
    const auto hit = shining.part.scene->first_surface(flight_ray(from, direction, near, farthest));
    if (!hit) {
      return;
    }
    const std::uint32_t face = shining.part.faces[hit->face];
    if (links_->emits[face] == shining.linking) {
      add(faces_[face], found);
    }
    if (holds(links_->shadows[face], shining.linking)) {
      return;
    }
    near = static_cast<double>(std::nextafter(hit->distance, std::numeric_limits<float>::max()));
  }
}

/// Embree's filters would slow all rays down, also those of scenes without links: each set of faces has its own scene.
void Occluders::link(unsigned threads, const GoOn& go_on) {
  const auto numbers = [&](const auto& is_in) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t face = 0; face < faces_.size(); ++face) {
      if (is_in(face)) {
        found.push_back(face);
      }
    }
    return found;
  };
  for (unsigned linking = 0; linking < kLinkings; ++linking) {
    std::vector<std::uint32_t> taking = numbers([&](auto face) { return holds(links_->shadows[face], linking); });
    if (taking.size() == faces_.size()) {
      continue;
    }
    const auto emits = [&](auto face) { return links_->emits[face] == linking && shines(faces_[face]); };
    if (!numbers(emits).empty()) {
      auto both = numbers([&](auto face) { return emits(face) || holds(links_->shadows[face], linking); });
      shining_.push_back({linking, part_of(std::move(both), threads, go_on)});
      passing_ |= LinkingSet{1} << linking;
    }
    const auto same = std::find_if(parts_.begin(), parts_.end(), [&](const Part& one) { return one.faces == taking; });
    if (same == parts_.end() && !taking.empty()) {
      parts_.push_back(part_of(std::move(taking), threads, go_on));
      shadows_[linking] = parts_.back().scene.get();
    } else {
      shadows_[linking] = taking.empty() ? nullptr : same->scene.get();
    }
  }
}

Occluders::Part Occluders::part_of(std::vector<std::uint32_t> faces, unsigned threads, const GoOn& go_on) const {
  TrianglePart part{scene_.part(0).vertices, {}};
  part.vertices.pop_back();  // the padding of MeshScene
  for (const std::uint32_t face : faces) {
    const auto corners = scene_.part(0).triangles.begin() + 3 * static_cast<std::ptrdiff_t>(face);
    part.triangles.insert(part.triangles.end(), corners, corners + 3);
  }
  return {std::move(faces), std::make_unique<MeshScene>(std::vector{std::move(part)}, threads, go_on)};
}

}  // namespace lamina

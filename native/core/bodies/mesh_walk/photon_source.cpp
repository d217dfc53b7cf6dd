// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/photon_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh_walk/surface_search.hpp"

namespace lamina {

namespace {

constexpr double kEverywhere = 0.05;     // share of photons drawn evenly by area, where the estimates may be wrong
constexpr int kTried = 4;                // positions on each patch
constexpr double kLongest = 1.0 / 24.0;  // side of a patch, relative to the solid's size
constexpr double kMostSides = 64.0;      // of a face

struct Face {
  Place corner;
  Ray first, second, normal;
  double area;

  Face(const Solid& solid, std::size_t number) {
    const auto [a, b, c] = solid.corners(number);
    corner = a;
    first = {b.x - a.x, b.y - a.y, b.z - a.z};
    second = {c.x - a.x, c.y - a.y, c.z - a.z};
    normal = {first.y * second.z - first.z * second.y, first.z * second.x - first.x * second.z,
              first.x * second.y - first.y * second.x};
    const double twice = std::sqrt(normal.dot(normal));
    area = 0.5 * twice;
    normal = twice > 0.0 ? Ray{normal.x / twice, normal.y / twice, normal.z / twice} : Ray{0.0, 0.0, 0.0};
  }
  /// A uniform position of part `number` of side * side parts of one area.
  Place at(std::uint32_t number, std::uint32_t side, Rng& rng) const {
    const double root = std::sqrt((number / side + rng.uniform()) / side);
    const double v = (number % side + rng.uniform()) / side;
    return corner.moved(first, root * (1.0 - v)).moved(second, root * v);
  }
  /// Columns and rows so that the parts of the face are not larger than patches should be.
  std::uint32_t side(double size) const {
    const double longest = std::sqrt(std::max(first.dot(first), second.dot(second)));
    return static_cast<std::uint32_t>(std::clamp(std::ceil(longest / (kLongest * size)), 1.0, kMostSides));
  }
};

/// The flux per area.
double arriving(const LampLight& light, const Ray& normal) {
  return light.irradiance * std::max(0.0, light.towards.dot(normal));
}

}  // namespace

PhotonSource::PhotonSource(const MeshWalk& walk, const Solid& solid, Lamp lamp, const Occluders* occluders,
                           ThreadPool& pool)
    : solid_(solid), lamp_(std::move(lamp)), occluders_(occluders) {
  std::vector<double> fluxes;
  std::vector<double> areas;
  double area = 0.0;
  for (std::size_t face = 0; face < solid.faces(); ++face) {
    const Face here(solid, face);
    Rng rng(face, 0);
    const std::uint32_t side = here.side(solid.size());
    for (std::uint32_t number = 0; number < side * side; ++number) {
      areas.push_back(here.area / (side * side));
      fluxes.push_back(0.0);
      for (int k = 0; k < kTried; ++k) {
        const Place place = here.at(number, side, rng);
        fluxes.back() += arriving(lamp_.light(place, LampPoint(rng)), here.normal) * areas.back() / kTried;
      }
      patches_.push_back({static_cast<std::uint32_t>(face), number, side});
      flux_ += fluxes.back();
    }
    area += here.area;
  }
  double sum = 0.0;
  for (std::size_t patch = 0; patch < patches_.size(); ++patch) {
    sum += flux_ > 0.0 ? (1.0 - kEverywhere) * fluxes[patch] / flux_ + kEverywhere * areas[patch] / area
                       : areas[patch] / area;
    up_to_.push_back(sum);
  }
  if (flux_ == 0.0) {
    flux_ = area;
  }
  windows_.emplace(walk, solid, *this, pool);
}

std::optional<MeshWalk::Photon> PhotonSource::photon(Rng& rng, WalkCounts& counts) const {
  const double drawn = rng.uniform() * up_to_.back();
  const std::size_t chosen = std::min<std::size_t>(
      static_cast<std::size_t>(std::upper_bound(up_to_.begin(), up_to_.end(), drawn) - up_to_.begin()),
      up_to_.size() - 1);
  const double probability = (up_to_[chosen] - (chosen > 0 ? up_to_[chosen - 1] : 0.0)) / up_to_.back();
  const auto& [face, number, side] = patches_[chosen];
  const Face here(solid_, face);
  const Place place = here.at(number, side, rng);
  const LampLight light = lamp_.light(place, LampPoint(rng));
  const double flux = arriving(light, here.normal) * here.area / (side * side);
  if (flux == 0.0 || solid_.is_opaque(face)) {
    return std::nullopt;
  }
  ++counts.rays;
  // Light that meets another face first is drawn there. A face inside another part of the mesh gets none.
  const double away = std::min(light.distance, 2.0 * solid_.size());
  const auto first = SurfaceSearch(solid_, place.moved(light.towards, away), -light.towards, 0, false).entering(away);
  if (first && first->distance < away - 1e-4 * solid_.size()) {
    return std::nullopt;
  }
  if (occluders_ != nullptr && occluders_->block(place, light.towards, light.distance, lamp_.linking())) {
    return std::nullopt;
  }
  return MeshWalk::Photon{place, here.normal, face, -light.towards, flux / (probability * flux_)};
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/mesh_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "events/survival.hpp"
#include "mesh_walk/surface_search.hpp"
#include "mesh_walk/walk_start.hpp"
#include "mesh_walk/weight_windows.hpp"
#include "phase/henyey_greenstein.hpp"

namespace lamina {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Walks start this far below the surface, relative to the solid's size: a few rounding errors of single precision.
constexpr double kInset = 2e-7;
// A move between faces that is shorter than this, relative to the solid's size, may be a rounding error.
constexpr double kStay = 1e-6;
// So many short moves in a row end a path: many faces may meet at a vertex, but not this many.
constexpr int kMostStays = 64;
constexpr double kMostParts = 16.0;  // of a photon that is split at one scattering

}  // namespace

Weights Scattering::phases(double cosine) const {
  const double first = HenyeyGreenstein{sample.g_first}.evaluate(cosine);
  Weights found;
  if (sample.g_first == sample.g_second) {
    found.fill(first / (4.0 * std::numbers::pi));
    return found;
  }
  const double second = HenyeyGreenstein{sample.g_second}.evaluate(cosine);
  for (std::size_t c = 0; c < kChannels; ++c) {
    found[c] = (first + static_cast<double>(sample.second[c]) * (second - first)) / (4.0 * std::numbers::pi);
  }
  return found;
}

void WalkCounts::add(const WalkCounts& other) {
  mirrored += other.mirrored;
  lost += other.lost;
  scatterings += other.scatterings;
  collisions += other.collisions;
  rays += other.rays;
}

/// One path, led by one channel.
class MeshWalk::Path {
 public:
  Path(const MeshWalk& walk, std::size_t leader, bool serves_all, const Rng& rng, WalkListener& listener,
       WalkCounts& counts)
      : solid_(walk.solid_),
        grid_(walk.grid_),
        boundary_(walk.boundary_),
        occluders_(walk.occluders_),
        leader_(leader),
        serves_all_(serves_all),
        rng_(rng),
        aside_(rng_.bits(), 0),
        listener_(listener),
        counts_(counts) {}

  void run(const Start& start) {
    if (enter(start)) {
      follow();
    }
  }

  void run(const Photon& photon, const WeightWindows* windows) {
    std::vector<Path> parts;
    windows_ = windows;
    parts_ = &parts;
    place_ = photon.place;
    normal_ = photon.normal;
    face_ = photon.face;
    direction_ = photon.direction;
    set_weights(photon.weight);
    meet_boundary();
    if (direction_.dot(normal_) > 0.0 && !follow_outside()) {
      return;
    }
    follow();
    while (!parts.empty()) {
      Path part = std::move(parts.back());
      parts.pop_back();
      part.follow();
    }
  }

 private:
  void follow() {
    while (fly() && survives_roulette()) {
    }
  }

  /// The light (backwards, from the eye) meets the boundary. Returns false if it does not enter.
  bool enter(const Start& start) {
    const Ray& normal = start.normal;
    normal_ = normal;
    place_ = start.place;
    ++counts_.rays;
    if (const auto face = start_face(solid_, start.place, normal); face && face->normal.dot(normal) > 0.0) {
      place_ = face->place;
      normal_ = face->normal;
      face_ = face->face;
      if (face->is_opaque) {
        return false;
      }
    }
    // Move inwards, so that at a vertex all adjacent faces lie outside of the start.
    place_ = place_.moved(normal, -kInset * solid_.size());
    const Ray in = start.view ? -*start.view : -about(normal);
    if (in.dot(normal) >= 0.0) {  // seen from behind
      return false;
    }
    listener_.starts(-in);
    double weight = 1.0;
    if (boundary_.kind() == SurfaceBoundary::Kind::kRough) {
      const auto outcome = boundary_.meet(in, normal, rng_);
      if (outcome.direction.dot(normal) >= 0.0 || outcome.weight == 0.0) {
        counts_.mirrored += outcome.weight / kChannels;
        return false;
      }
      direction_ = outcome.direction;
      weight = outcome.weight;
    } else {
      const auto outcome = boundary_.enter(in, normal);
      counts_.mirrored += (1.0 - outcome.weight) / kChannels;
      direction_ = outcome.direction;
      weight = outcome.weight;
    }
    if (weight == 0.0) {
      return false;
    }
    // A direction that enters with respect to the given normal may leave with respect to the face's normal.
    if (const double along = direction_.dot(normal_); along > 0.0) {
      direction_ = mirrored_at(normal_, direction_, along);
    }
    set_weights(weight);
    return true;
  }

  void set_weights(double weight) {
    if (serves_all_) {
      weights_.fill(weight);
      densities_.fill(1.0);
    } else {
      weights_[leader_] = kChannels * weight;
      densities_[leader_] = kChannels;
    }
  }

  Ray about(const Ray& normal) {
    const Ray up = lambert_ray(rng_);
    const auto [first, second] = tangents_of(normal.x, normal.y, normal.z);
    return normalised({up.x * first[0] + up.y * second[0] + up.z * normal.x,
                       up.x * first[1] + up.y * second[1] + up.z * normal.y,
                       up.x * first[2] + up.y * second[2] + up.z * normal.z});
  }

  /// Moves to the next scattering, or to the surface and refracts or reflects there. Returns false if the walk ends.
  bool fly() {
    BrickFlight flight(grid_, place_, direction_, serves_all_ ? kChannels : leader_);
    SurfaceSearch surface(solid_, place_, direction_, shells_, on_surface_);
    // Numbers of this flight's own, so that paths of other leaders stay in step after a different number of collisions.
    Rng chances(rng_.bits(), 0);
    std::optional<Crossing> end;
    double free = 0.0;  // distance up to which the flight meets no surface
    if (on_surface_) {
      // At an edge a direction that enters through one face may leave through another face, and rounding errors may let
      // the ray miss that face.
      ++counts_.rays;
      end = surface.leaving(kInfinity);
      if (!end) {
        return leave(normal_);
      }
      free = end->distance;
    } else {
      free = solid_.clearance(place_);
    }
    for (;;) {
      const double distance = flight.advance(-std::log(chances.uniform()), end ? end->distance : kInfinity);
      if (distance > free) {
        if (!end) {
          ++counts_.rays;
          end = surface.leaving(distance);
        }
        if (end) {
          return cross(*end);
        }
        free = distance;
      }
      const Place here = place_.moved(direction_, distance);
      if (distance == kInfinity || !solid_.box_holds(here)) {
        if (const auto last = surface.leaving(kInfinity)) {
          return cross(*last);
        }
        counts_.lost += mean_of(weights_) / kChannels;
        return false;
      }
      ++counts_.collisions;
      const CoefficientGrid::Sample sample = grid_.at(here, chances);
      if (is_real(sample, flight.majorant(), chances)) {
        place_ = here;
        on_surface_ = false;
        shells_ = surface.shells_at(distance);
        scatter(sample);
        return true;
      }
    }
  }

  /// Accepts or rejects a tentative collision, with the probability of the leading channel.
  bool is_real(const CoefficientGrid::Sample& sample, double majorant, Rng& chances) {
    const bool real = chances.uniform() * majorant < static_cast<double>(sample.extinction[leader_]);
    Weights probabilities;
    Weights kept;  // the part that is not absorbed
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto extinction = static_cast<double>(sample.extinction[c]);
      probabilities[c] = real ? extinction : majorant - extinction;
      kept[c] = real ? static_cast<double>(sample.scattering[c]) : majorant - extinction;
    }
    weigh(probabilities, kept);
    return real;
  }

  /// Updates the weights after a random outcome. `probabilities`: of the outcome in each channel, up to a common
  /// factor; `kept`: the same without light that is absorbed.
  void weigh(const Weights& probabilities, const Weights& kept) {
    double mean = 0.0;
    for (std::size_t c = 0; c < kChannels; ++c) {
      mean += densities_[c] * probabilities[c] * (1.0 / kChannels);
    }
    for (std::size_t c = 0; c < kChannels; ++c) {
      weights_[c] *= kept[c] / mean;
      densities_[c] *= probabilities[c] / mean;
    }
  }

  void scatter(const CoefficientGrid::Sample& sample) {
    ++counts_.scatterings;
    ++scatterings_;
    stays_ = 0;
    listener_.scatters({place_, direction_, sample, weights_, leader_, normal_, shells_}, aside_);
    if (windows_ != nullptr) {
      split(sample);
    }
    draw_direction(sample);
  }

  /// Splits a photon whose weight is at least twice the target of its cell. The other parts start here later.
  void split(const CoefficientGrid::Sample& sample) {
    target_ = windows_->target(place_);
    const double parts = std::min(kMostParts, std::floor(mean_of(weights_) / target_));
    if (parts < 2.0) {
      return;
    }
    for (double& weight : weights_) {
      weight /= parts;
    }
    for (int part = 1; part < static_cast<int>(parts); ++part) {
      parts_->push_back(*this);
      Path& other = parts_->back();
      other.rng_ = Rng(rng_.bits(), 0);
      other.aside_ = Rng(other.rng_.bits(), 0);
      other.draw_direction(sample);
    }
  }

  /// Draws the direction after a scattering by the phase function of the leading channel.
  void draw_direction(const CoefficientGrid::Sample& sample) {
    const HenyeyGreenstein first{sample.g_first};
    if (sample.g_first == sample.g_second) {
      direction_ = scattered(direction_, first.sample(rng_.uniform()), rng_);
      return;
    }
    // Draw from the mixture of phase functions in the leading channel.
    const HenyeyGreenstein second{sample.g_second};
    const bool chosen = rng_.uniform() < static_cast<double>(sample.second[leader_]);
    const double cosine = (chosen ? second : first).sample(rng_.uniform());
    const double p_first = first.evaluate(cosine);
    const double p_second = second.evaluate(cosine);
    Weights phases;
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto share = static_cast<double>(sample.second[c]);
      phases[c] = share * p_second + (1.0 - share) * p_first;
    }
    weigh(phases, phases);
    direction_ = scattered(direction_, cosine, rng_);
  }

  /// Light from inside meets the surface. Returns false if the walk ends.
  bool cross(const Crossing& crossing) {
    if (crossing.is_opaque || !move_to(crossing)) {
      return false;
    }
    on_surface_ = true;
    meet_boundary();
    return direction_.dot(normal_) <= 0.0 || leave(normal_);
  }

  /// Moves to a point of the surface. Returns false if the walk stays in one place: at a concave edge rounding errors
  /// may let light leave through one face and enter through the other again and again.
  bool move_to(const Crossing& crossing) {
    stays_ = crossing.distance > kStay * solid_.size() ? 0 : stays_ + 1;
    if (stays_ > kMostStays) {
      counts_.lost += mean_of(weights_) / kChannels;
      return false;
    }
    place_ = place_.moved(direction_, crossing.distance);
    normal_ = crossing.normal;
    face_ = crossing.face;
    shells_ = 1;
    return true;
  }

  void meet_boundary() {
    if (boundary_.kind() != SurfaceBoundary::Kind::kMatched) {
      listener_.meets_boundary({place_, normal_, face_, direction_, weights_, scatterings_}, aside_);
    }
    turn(boundary_.meet(direction_, normal_, rng_));
  }

  bool leave(const Ray& normal) {
    return listener_.leaves({place_, normal, face_, direction_, weights_, scatterings_}) && follow_outside();
  }

  /// Follows light outside. Returns true if the light enters the solid again.
  bool follow_outside() {
    auto lit = occluders_ == nullptr ? Occluders::kAll : occluders_->solid_lit();  // of what the light has left
    for (;;) {
      ++counts_.rays;
      const auto crossing = SurfaceSearch(solid_, place_, direction_, shells_, true).entering(kInfinity);
      if (occluders_ != nullptr) {
        const double end = crossing ? crossing->distance : kInfinity;
        const auto other = occluders_->first(place_, direction_, end);
        listener_.meets_emission(occluders_->emitted(place_, direction_, end, other, lit), weights_);
        if (other) {
          if (!reflect(*other)) {
            return false;
          }
          lit = other->lit;
          continue;
        }
      }
      if (!crossing) {
        listener_.escapes(direction_, weights_);
        return false;
      }
      if (crossing->is_opaque || !move_to(*crossing)) {
        return false;
      }
      meet_boundary();
      if (const bool enters = direction_.dot(normal_) <= 0.0; enters || !survives_roulette()) {
        return enters;
      }
      lit = occluders_ == nullptr ? lit : occluders_->solid_lit();
    }
  }

  /// Light outside meets an occluder. Returns false if none is left.
  bool reflect(const Occluders::Hit& other) {
    ++counts_.rays;
    listener_.meets_occluder(other, weights_, aside_);
    for (std::size_t c = 0; c < kChannels; ++c) {
      weights_[c] *= static_cast<double>(other.face.albedo[c]);
    }
    if (mean_of(weights_) == 0.0) {
      return false;
    }
    place_ = other.place;
    direction_ = about(other.normal);
    return survives_roulette();
  }

  void turn(const SurfaceBoundary::Outcome& outcome) {
    direction_ = outcome.direction;
    for (double& weight : weights_) {
      weight *= outcome.weight;
    }
  }

  bool survives_roulette() {
    const double before = mean_of(weights_) / target_;
    double after = before;
    if (!survives(after, aside_)) {
      return false;
    }
    if (after != before) {
      for (double& weight : weights_) {
        weight *= after / before;
      }
    }
    return true;
  }

  const Solid& solid_;
  const CoefficientGrid& grid_;
  const SurfaceBoundary& boundary_;
  const Occluders* occluders_;
  std::size_t leader_;
  bool serves_all_;  ///< channels, not the leader only
  Rng rng_;
  Rng aside_;  ///< for roulette and the listener, which need numbers at other times in other channels
  WalkListener& listener_;
  WalkCounts& counts_;
  const WeightWindows* windows_ = nullptr;
  std::vector<Path>* parts_ = nullptr;  ///< of a photon
  double target_ = 1.0;                 ///< the weight that the path should have

  Place place_;
  Ray direction_;
  Ray normal_;  ///< normal of the face that was hit last
  std::uint32_t face_ = 0;
  Weights weights_ = {};
  Weights densities_ = {};  ///< of the path, if each of the channels that it serves led it, relative to the mean of all
  std::uint64_t scatterings_ = 0;
  int stays_ = 0;   ///< short moves since the last longer move or scattering
  int shells_ = 1;  ///< number of parts of the mesh that contain the position
  bool on_surface_ = true;
};

void MeshWalk::run(const Start& start, Rng& rng, WalkListener& listener, WalkCounts& counts) const {
  const bool grey = grid_.is_grey();
  for (std::size_t leader = 0; leader < kChannels; ++leader) {
    // In a grey grid equal numbers would give three equal paths, of which each serves all channels.
    Path(*this, leader, grey, grey ? Rng(rng.bits(), leader) : rng, listener, counts).run(start);
  }
}

void MeshWalk::shine(const Photon& photon, std::size_t leader, Rng& rng, WalkListener& listener, WalkCounts& counts,
                     const WeightWindows* windows) const {
  Path(*this, leader, true, Rng(rng.bits(), leader), listener, counts).run(photon, windows);
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral_walks/photon_walk.hpp"

#include <algorithm>
#include <cmath>

#include "events/survival.hpp"
#include "lateral_walks/lateral_walk_stack.hpp"
#include "lateral_walks/unscattered_path.hpp"
#include "walks/surface_meeting.hpp"

namespace lamina {
namespace {

using Element = WalkElements::Element;
using Kind = Element::Kind;

struct Photon {
  Ray ray;
  double weight = 1.0;
  double x = 0.0;  ///< in mm
  double y = 0.0;

  void move(double length) {
    x += ray.x * length;
    y += ray.y * length;
  }
};

class PhotonWalk final : public LateralWalk {
 public:
  PhotonWalk(LateralWalkStack stack, double mu_i)
      : stack_(std::move(stack)), beam_(stack_.walked, mu_i, 0.0, false), path_(stack_, beam_) {
    mirrored = beam_.reflected;
    unscattered = beam_.transmitted;
    for (std::size_t k = 0; k < beam_.at.size(); ++k) {
      add_start(k, true, beam_.at[k].down, beam_.at[k].at_top);
      add_start(k, false, beam_.at[k].up, beam_.at[k].at_bottom);
    }
  }

  Leaving sample(Rng& rng, std::uint64_t& events) const override {
    Leaving leaving;
    const auto count = static_cast<std::ptrdiff_t>(stack_.walked.elements.size());
    if (mirrored > 0.0) {
      leaving.add(true, path_.draw(-1, false, rng), mirrored);
    }
    if (unscattered > 0.0) {
      leaving.add(false, path_.draw(count, true, rng), unscattered);
    }
    if (starts_.empty()) {
      return leaving;
    }
    const double choice = rng.uniform() * starts_.back().until;
    const auto start =
        std::find_if(starts_.begin(), starts_.end() - 1, [choice](const Start& one) { return one.until >= choice; });
    Photon photon{start->in};
    photon.x = path_.draw(start->element, start->from_above, rng);
    bool first = true;
    for (std::ptrdiff_t k = start->element; k >= 0 && k < count; k += photon.ray.z < 0.0 ? 1 : -1) {
      if (!meet(static_cast<std::size_t>(k), photon, first, rng, events)) {
        return leaving;
      }
      first = false;
    }
    leaving.add(photon.ray.z > 0.0, std::hypot(photon.x, photon.y), starts_.back().until * photon.weight);
    return leaving;
  }

 private:
  struct Start {
    std::ptrdiff_t element;
    bool from_above;
    Ray in;
    double until;  ///< cumulative power that is scattered, up to and including this start
  };

  /// Adds an element where the beam arrives with this power and may be scattered for the first time.
  void add_start(std::size_t element, bool from_above, const Ray& in, double power) {
    const Element& here = stack_.walked.elements[element];
    double share = 0.0;
    if (here.kind == Kind::kMedium) {
      share = here.medium.albedo > 0.0 ? -std::expm1(-here.medium.tau / std::abs(in.z)) : 0.0;
    } else if (here.is_scattering_surface()) {
      share = 1.0;
    }
    if (power * share > 0.0) {
      const double before = starts_.empty() ? 0.0 : starts_.back().until;
      starts_.push_back({static_cast<std::ptrdiff_t>(element), from_above, in, before + power * share});
    }
  }

  /// Returns false if the photon is lost. With `first`, scattering in a medium is forced.
  bool meet(std::size_t element, Photon& photon, bool first, Rng& rng, std::uint64_t& events) const {
    const Element& here = stack_.walked.elements[element];
    if (here.kind == Kind::kMedium) {
      return cross(element, photon, first, rng, events);
    }
    if (here.is_polished()) {
      return meet_polished(stack_.walked, element, photon.ray, photon.weight, rng);
    }
    ++events;
    if (here.kind == Kind::kLambert && stack_.spread > 0.0) {
      displace(photon, rng);
    }
    return scatter_at_surface(here, photon.ray, photon.weight, rng);
  }

  /// Displaces light that returns from below the end of a conservative half-space, see LateralWalkStack::spread.
  void displace(Photon& photon, Rng& rng) const {
    const double u = rng.uniform();
    const double r = stack_.spread * std::sqrt((1.0 - u) * (1.0 + u)) / u;
    const Azimuth azimuth(rng);
    photon.x += r * azimuth.cosine;
    photon.y += r * azimuth.sine;
  }

  bool cross(std::size_t element, Photon& photon, bool forced, Rng& rng, std::uint64_t& events) const {
    const Element& here = stack_.walked.elements[element];
    const DepthScale& scale = stack_.scales[element];
    const double tau = here.medium.tau;
    const bool from_above = photon.ray.z < 0.0;
    double depth = from_above ? 0.0 : tau;
    DepthScale::Place place = from_above ? scale.top() : scale.bottom();
    for (;; forced = false) {
      const double mu = std::abs(photon.ray.z);
      const bool down = photon.ray.z < 0.0;
      const double to_face = (down ? tau - depth : depth) / mu;
      double optical = 0.0;
      if (forced) {
        optical = -std::log1p(std::expm1(-to_face) * rng.uniform());
      } else {
        optical = -std::log(rng.uniform());
        if (optical >= to_face) {
          photon.move(scale.length(place, down ? scale.bottom() : scale.top(), to_face, mu));
          return true;
        }
      }
      depth = std::clamp(depth - photon.ray.z * optical, 0.0, tau);
      const DepthScale::Place next = scale.at(depth);
      photon.move(scale.length(place, next, optical, mu));
      place = next;
      ++events;
      const LocalScattering local = here.graded ? here.graded->at_depth(depth)
                                                : LocalScattering{here.medium.albedo, 0.0, &here.medium.phase, nullptr};
      photon.weight *= local.albedo();
      if (!survives(photon.weight, rng)) {
        return false;
      }
      photon.ray = scattered(photon.ray, local.sample(rng.uniform()), rng);
    }
  }

  LateralWalkStack stack_;
  WalkBeam beam_;
  UnscatteredPath path_;
  std::vector<Start> starts_;
};

}  // namespace

std::unique_ptr<LateralWalk> make_photon_walk(const Stack& stack, const std::vector<DepthScale>& scales, double mu_i) {
  return std::make_unique<PhotonWalk>(LateralWalkStack(stack, scales), mu_i);
}

}  // namespace lamina

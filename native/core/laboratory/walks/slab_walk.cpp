// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/slab_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "events/survival.hpp"
#include "walks/flight.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

enum class Score { kFromBothEnds, kAlongFlight, kAtCollision, kFlux };

/// The slab is turned so that the exit face is the top: for transmission, light enters from below.
template <typename Phase, Score kScore>
class SlabWalk final : public Walk {
 public:
  SlabWalk(const Phase& phase, const Medium& medium, const WalkTarget& target)
      : phase_(phase), albedo_(medium.albedo), tau_(medium.tau) {
    const bool through = target.path == Path::kTransmit;
    in_ = {sine_of(target.mu_i), 0.0, through ? target.mu_i : -target.mu_i};
    const double sine = sine_of(target.mu_o);
    out_ = {sine * std::cos(target.dphi), sine * std::sin(target.dphi), target.mu_o};
    slowness_ = 1.0 / target.mu_o;
    kept_by_all_ = std::exp(-tau_ * slowness_);
    begin_ = through ? tau_ : 0.0;
    unscattered_ = std::exp(-tau_ / target.mu_i);
    power_ = albedo_ > 0.0 ? -std::expm1(-tau_ / target.mu_i) : 0.0;
    scale_ = albedo_ * slowness_ / (4.0 * pi);
    if constexpr (kScore == Score::kFlux) {
      known_ = through ? unscattered_ : 0.0;
      scale_ = 1.0;
    } else if constexpr (kScore != Score::kAtCollision) {
      const double length = tau_ / target.mu_i;
      const double kept = std::exp(-begin_ * slowness_);
      known_ = scale_ * flown(in_, kept, begin_, length, unscattered_) * phase_.evaluate(in_.dot(out_));
    }
  }

  double sample(Rng& rng, std::uint64_t& events) const override {
    if (power_ == 0.0) {
      return known_;
    }
    Ray ray = in_;
    double weight = 1.0;
    double score = 0.0;
    double depth = begin_;
    double choice = unscattered_ + power_ * rng.uniform();
    for (;;) {
      depth = std::clamp(depth + ray.z * std::log(choice), 0.0, tau_);
      ++events;
      const double kept = kScore == Score::kFlux ? 0.0 : std::exp(-depth * slowness_);
      if constexpr (kScore == Score::kAtCollision) {
        score += weight * kept * phase_.evaluate(ray.dot(out_));
      }
      weight *= albedo_;
      if (!survives(weight, rng)) {
        break;
      }
      if constexpr (kScore == Score::kFromBothEnds) {
        const double cosine = phase_.sample(rng.uniform());
        const Ray other = scattered(out_, cosine, rng);
        const double length = to_face(other, depth);
        score += weight * flown(other, kept, depth, length, std::exp(-length)) *
                 both_ends(phase_.evaluate(ray.dot(other)), phase_.evaluate(cosine));
      }
      const double cosine = phase_.sample(rng.uniform());
      ray = scattered(ray, cosine, rng);
      const double length = to_face(ray, depth);
      const double through = std::exp(-length);
      if constexpr (kScore == Score::kFromBothEnds) {
        score += weight * flown(ray, kept, depth, length, through) *
                 both_ends(phase_.evaluate(cosine), phase_.evaluate(ray.dot(out_)));
      } else if constexpr (kScore == Score::kAlongFlight) {
        score += weight * flown(ray, kept, depth, length, through) * phase_.evaluate(ray.dot(out_));
      }
      choice = rng.uniform();
      if (choice <= through) {
        if constexpr (kScore == Score::kFlux) {
          score = ray.z > 0.0 ? weight : 0.0;
        }
        break;
      }
    }
    return known_ + power_ * scale_ * score;
  }

 private:
  double to_face(const Ray& ray, double depth) const { return ray.z > 0.0 ? depth / ray.z : (depth - tau_) / ray.z; }

  double flown(const Ray& ray, double kept, double depth, double length, double through) const {
    return ray.z < 0.0 ? flight_away(kept, kept_by_all_, through, -ray.z * slowness_)
                       : flight_towards(kept, through, depth * slowness_, length);
  }

  Phase phase_;
  double albedo_;
  double tau_;
  Ray in_;
  Ray out_;
  double slowness_ = 0.0;     ///< 1 / mu_o
  double kept_by_all_ = 0.0;  ///< transmittance of the slab along the exit beam
  double begin_ = 0.0;        ///< depth of entry, below the exit face
  double unscattered_ = 0.0;
  double power_ = 0.0;  ///< probability of a first collision
  double scale_ = 1.0;
  double known_ = 0.0;
};

}  // namespace

std::unique_ptr<Walk> make_slab_walk(const Medium& medium, const WalkTarget& target, NextEvent next_event) {
  const NextEvent chosen = fitted(next_event, medium.phase);
  return medium.phase.visit([&](const auto& phase) -> std::unique_ptr<Walk> {
    using Phase = std::decay_t<decltype(phase)>;
    if (target.flux) {
      return std::make_unique<SlabWalk<Phase, Score::kFlux>>(phase, medium, target);
    }
    if (chosen == NextEvent::kFromBothEnds) {
      return std::make_unique<SlabWalk<Phase, Score::kFromBothEnds>>(phase, medium, target);
    }
    if (chosen == NextEvent::kAlongFlight) {
      return std::make_unique<SlabWalk<Phase, Score::kAlongFlight>>(phase, medium, target);
    }
    return std::make_unique<SlabWalk<Phase, Score::kAtCollision>>(phase, medium, target);
  });
}

}  // namespace lamina

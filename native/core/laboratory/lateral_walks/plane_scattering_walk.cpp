// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral_walks/plane_scattering_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "events/survival.hpp"
#include "lateral_walks/term_guide.hpp"
#include "matter/graded_medium.hpp"
#include "matter/joined_media.hpp"
#include "walks/branch_stack.hpp"
#include "walks/slab_ray.hpp"

namespace lamina {
namespace {

using std::numbers::pi;
using Place = DepthScale::Place;

/// A pending factor S of the part below an optical depth, between directions a (up) and b (down).
struct Branch {
  double depth = 0.0;
  Place place;
  SlabRay a;
  SlabRay b;

  double slowness() const { return 1.0 / a.mu + 1.0 / b.mu; }
};

struct Displacement {
  double x = 0.0;
  double y = 0.0;

  void add(const SlabRay& ray, double length) {
    x += ray.x * length;
    y += ray.y * length;
  }
  double distance() const { return std::hypot(x, y); }
};

/// The share of directions sampled uniformly over a hemisphere instead of from the phase function. `forward` is the
/// mean cosine with that hemisphere: 1 for isotropic scattering, small if most light goes into the hemisphere, at least
/// 1/2 if little does.
double uniform_share(double forward) {
  constexpr double kHalf = 0.5;
  return forward > 0.0 ? (1.0 - forward) * (1.0 - forward) : std::max(kHalf, 1.0 + forward);
}

SlabRay any_direction(Rng& rng) { return SlabRay::of(rng.uniform(), 2.0 * pi * rng.uniform()); }

class PlaneScatteringWalk final : public LateralWalk {
 public:
  PlaneScatteringWalk(GradedMedium medium, DepthScale scale, bool has_base, double mu_i)
      : medium_(std::move(medium)),
        scale_(std::move(scale)),
        has_base_(has_base),
        in_(SlabRay::of(mu_i, 0.0)),
        guide_(medium_),
        uniform_on_(uniform_share(medium_.sharpest_phase().moment(1))),
        uniform_back_(uniform_share(-medium_.sharpest_phase().moment(1))) {
    const double optical = medium_.tau() / mu_i;
    unscattered = has_base ? 0.0 : std::exp(-optical);
    if (unscattered > 0.0) {
      straight_ = in_.x * scale_.length(scale_.top(), scale_.bottom(), optical, mu_i);
    }
  }

  Leaving sample(Rng& rng, std::uint64_t& events) const override {
    Leaving leaving;
    if (unscattered > 0.0) {
      leaving.add(false, straight_, unscattered);
    }
    reflect(leaving, rng, events);
    if (!has_base_ && unscattered < 1.0) {
      transmit(leaving, rng, events);
    }
    return leaving;
  }

  /// A sample of the BRDF for light that leaves in the direction `out`, without its position.
  double brdf(const SlabRay& out, Rng& rng, std::uint64_t& events) const {
    Displacement moved;
    double weight = 1.0 / (4.0 * pi * out.mu * in_.mu);
    return walk({0.0, scale_.top(), out, in_}, weight, moved, rng, events) ? weight : 0.0;
  }

 private:
  /// Samples the reflected flux: S / (4 pi mu_b) over all directions a, with a density proportional to their cosines.
  void reflect(Leaving& leaving, Rng& rng, std::uint64_t& events) const {
    const SlabRay out = SlabRay::of(std::sqrt(rng.uniform()), 2.0 * pi * rng.uniform());
    Displacement moved;
    double weight = 1.0 / (4.0 * out.mu * in_.mu);
    if (walk({0.0, scale_.top(), out, in_}, weight, moved, rng, events)) {
      leaving.add(true, moved.distance(), weight);
    }
  }

  void transmit(Leaving& leaving, Rng& rng, std::uint64_t& events) const {
    double weight = 1.0 - unscattered;
    double depth = 0.0;
    Place place = scale_.top();
    SlabRay ray = in_;
    Displacement moved;
    for (bool first = true;; first = false) {
      const double left = (medium_.tau() - depth) / ray.mu;
      const double optical = first ? -std::log1p(std::expm1(-left) * rng.uniform()) : -std::log(rng.uniform());
      if (!first && optical >= left) {
        moved.add(ray, scale_.length(place, scale_.bottom(), left, ray.mu));
        leaving.add(false, moved.distance(), weight);
        return;
      }
      depth = std::min(depth + ray.mu * optical, medium_.tau());
      const Place next = scale_.at(depth);
      moved.add(ray, scale_.length(place, next, optical, ray.mu));
      place = next;
      ++events;
      const LocalScattering scattering = medium_.at_depth(depth);
      const double chance = guide_.before(ray.mu, depth, scattering.albedo());
      const bool from_below = rng.uniform() < chance;
      if (from_below) {
        // Light passes into the part below and comes back to be scattered here.
        const SlabRay back = any_direction(rng);
        weight *= 1.0 / (2.0 * back.mu * chance);
        if (!walk({depth, place, back, ray}, weight, moved, rng, events)) {
          return;
        }
        ray = back;
      } else {
        weight /= 1.0 - chance;
      }
      ray = turned(ray, from_below, scattering, weight, rng);
      if (!(ray.mu > 0.0) || !survives(weight, rng)) {
        return;
      }
    }
  }

  /// Multiplies the weight by a sample of S of the branch, and adds its displacement. Returns false if the sample is 0.
  bool walk(Branch branch, double& weight, Displacement& moved, Rng& rng, std::uint64_t& events) const {
    BranchStack<Branch> waiting;
    // Divide by the slowness s of each branch when it is created, and by that of the first branch outside `value`.
    // Russian roulette then acts on the expected contribution of the branches.
    weight /= branch.slowness();
    double value = 1.0;
    for (;;) {
      ++events;
      const double s = branch.slowness();
      const double left = medium_.tau() - branch.depth;
      if (medium_.ground() > 0.0) {
        const double from_ground = 4.0 * (branch.a.mu + branch.b.mu) * medium_.ground() * std::exp(-s * left);
        const double odds = guide_.ground(branch.a.mu, branch.b.mu, branch.depth, from_ground);
        if (rng.uniform() < odds) {
          value *= from_ground / odds;
          move(branch, scale_.bottom(), left, moved);
          if (!waiting.pop(branch)) {
            break;
          }
          continue;
        }
        value /= 1.0 - odds;
      }
      const double span = -std::expm1(-s * left);
      const double fall = -std::log1p(-span * rng.uniform()) / s;
      const double depth = std::min(branch.depth + fall, medium_.tau());
      const Place place = scale_.at(depth);
      move(branch, place, fall, moved);
      const LocalScattering scattering = medium_.at_depth(depth);
      const double once = scattering.evaluate(turned_back(branch.a, branch.b));
      const TermGuide::Shares shares = guide_.terms(branch.a.mu, branch.b.mu, depth, once, scattering.albedo());
      const double choice = rng.uniform();
      const bool on_a = choice < shares.on_a + shares.on_both;
      const bool on_b = choice >= shares.on_a && choice < shares.on_a + shares.on_both + shares.on_b;
      const double one_side = on_a ? shares.on_a : shares.on_b;
      value *= span / (on_a && on_b ? shares.on_both : on_a || on_b ? one_side : shares.none());
      if (on_a && on_b) {
        // Light goes up along q, is scattered here, and goes down along p.
        const SlabRay q = any_direction(rng);
        const SlabRay p = turned(q, true, scattering, value, rng);
        if (!(p.mu > 0.0)) {
          return false;
        }
        value *= 0.5 / (p.mu * q.mu);
        const Branch other{depth, place, q, branch.b};
        waiting.push(other);
        branch = {depth, place, branch.a, p};
        value /= other.slowness() * branch.slowness();
      } else if (on_a || on_b) {
        const SlabRay next = turned(on_a ? branch.a : branch.b, false, scattering, value, rng);
        if (!(next.mu > 0.0)) {
          return false;
        }
        branch = on_a ? Branch{depth, place, next, branch.b} : Branch{depth, place, branch.a, next};
        value /= next.mu * branch.slowness();
      } else {
        value *= once;
        if (!waiting.pop(branch)) {
          break;
        }
      }
      if (!survives(value, rng)) {
        return false;
      }
    }
    weight *= value;
    return value != 0.0;
  }

  /// Moves down along b and up along a, until the optical depth has grown by `fall`.
  void move(const Branch& branch, const Place& to, double fall, Displacement& moved) const {
    for (const SlabRay& ray : {branch.a, branch.b}) {
      moved.add(ray, scale_.length(branch.place, to, fall / ray.mu, ray.mu));
    }
  }

  /// Samples a direction of light that scatters into `from`, or out of it: on the same side of the layer, or with
  /// `back` on the other side. A direction beyond the horizon has a negative cosine. Directions are drawn from the
  /// phase function or uniformly, and `value` is multiplied by k / (4 pi) over the probability density of the mixture.
  SlabRay turned(const SlabRay& from, bool back, const LocalScattering& scattering, double& value, Rng& rng) const {
    const double uniform = back ? uniform_back_ : uniform_on_;
    SlabRay ray;
    if (rng.uniform() < uniform) {
      ray = any_direction(rng);
    } else {
      ray = SlabFrame(from).turned(scattering.sample(rng.uniform()), 2.0 * pi * rng.uniform());
      ray.mu = back ? -ray.mu : ray.mu;
    }
    const double k = scattering.evaluate(back ? turned_back(from, ray) : passed_on(from, ray));
    value *= k > 0.0 ? k / ((1.0 - uniform) * k / scattering.albedo() + 2.0 * uniform) : 0.0;
    return ray;
  }

  GradedMedium medium_;
  DepthScale scale_;
  bool has_base_;
  SlabRay in_;
  TermGuide guide_;
  double uniform_on_;      ///< share of directions sampled uniformly on the same side of the layer
  double uniform_back_;    ///< the same on the other side
  double straight_ = 0.0;  ///< mm by which unscattered light is displaced
};

/// The same walk between two directions.
class SlabScatteringWalk final : public Walk {
 public:
  SlabScatteringWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi)
      : plane_(medium, DepthScale({{0.0, 0.0, 1.0}, {medium.tau(), medium.tau(), 1.0}}), true, mu_i),
        out_(SlabRay::of(mu_o, dphi)) {}

  double sample(Rng& rng, std::uint64_t& events) const override { return plane_.brdf(out_, rng, events); }

 private:
  PlaneScatteringWalk plane_;
  SlabRay out_;
};

}  // namespace

std::unique_ptr<Walk> make_slab_scattering_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi) {
  return std::make_unique<SlabScatteringWalk>(medium, mu_o, mu_i, dphi);
}

std::unique_ptr<LateralWalk> make_plane_scattering_walk(const Stack& stack, const std::vector<DepthScale>& scales,
                                                        double mu_i) {
  GradedMedium medium = joined_media(stack, true);
  const bool endless = std::isinf(medium.tau());
  if (endless && medium.knots().back().albedo == 1.0) {
    throw std::invalid_argument("the walk of the scattering equation cannot end in a conservative half-space");
  }
  // Skip interfaces, which do nothing here and have no length.
  std::vector<DepthScale> lengths;
  for (std::size_t k = 0; k < stack.layers.size(); ++k) {
    if (!std::holds_alternative<Interface>(stack.layers[k])) {
      lengths.push_back(scales.at(k));
    }
    if (lengths.size() > 0 && std::isinf(lengths.back().thickness())) {
      break;
    }
  }
  const bool has_base = endless || stack.base.kind != Base::Kind::kNone;
  return std::make_unique<PlaneScatteringWalk>(std::move(medium), DepthScale::joined(lengths), has_base, mu_i);
}

}  // namespace lamina

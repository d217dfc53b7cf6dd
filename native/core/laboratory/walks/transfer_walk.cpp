// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/transfer_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "events/survival.hpp"
#include "walks/flake_scatter.hpp"
#include "walks/flight.hpp"
#include "walks/slab_walk.hpp"
#include "walks/stack_walk.hpp"

namespace lamina {
namespace {

using std::numbers::pi;
using Kind = WalkElements::Element::Kind;

class TransferWalk final : public StackWalk {
 public:
  TransferWalk(WalkElements stack, const WalkTarget& target, NextEvent next_event)
      : StackWalk(std::move(stack), target) {
    for (const WalkElements::Element& element : this->stack().elements) {
      // Flights are integrated in closed form in homogeneous media.
      along_.push_back(next_event != NextEvent::kAtCollision && !element.graded && !element.medium.flakes);
      both_.push_back(along_.back() && fitted(next_event, element.medium.phase) == NextEvent::kFromBothEnds &&
                      !target.flux);
    }
    begin();
  }

 private:
  bool cross(std::size_t element, const Exits& out, Light& light, bool first, double& score, Rng& rng,
             std::uint64_t& events) const override {
    const WalkElements::Element& here = this->stack().elements[element];
    const Medium& medium = here.medium;
    const bool along = along_[element];
    double depth = light.ray.z < 0.0 ? 0.0 : medium.tau;
    double share = 1.0;  // the balance heuristic's weight of this flight
    for (bool forced = first;; forced = false) {
      const double length = to_face(medium, light.ray, depth);
      const double through = std::exp(-length);
      if (along && !is_flux() && !forced) {
        score += light.weight * share * on_flight(element, out, light.ray, depth, length, through);
      }
      double choice = rng.uniform();
      if (forced) {
        choice = through + (1.0 - through) * choice;
      } else if (choice <= through) {
        return true;
      }
      depth = std::clamp(depth + light.ray.z * std::log(choice) / extinction(medium, light.ray), 0.0, medium.tau);
      ++events;
      if (medium.flakes) {
        const FlakeScatter flakes(*medium.flakes, light.ray, rng);
        if (!is_flux()) {
          score += light.weight * from_flakes(element, out, flakes, depth);
        }
        const FlakeScatter::Event event = flakes.sample(rng);
        light.ray = event.ray;
        light.weight *= medium.albedo * event.kept;
        if (!survives(light.weight, rng)) {
          return false;
        }
        light.earlier = earlier(density(element, event.density, light.ray));
        continue;
      }
      if (here.graded) {
        const LocalScattering local = here.graded->at_depth(depth);
        if (!is_flux()) {
          score += light.weight * at_depth(element, out, light.ray, depth, local);
        }
        light.weight *= local.albedo();
        if (!survives(light.weight, rng)) {
          return false;
        }
        const double cosine = local.sample(rng.uniform());
        light.ray = scattered(light.ray, cosine, rng);
        if (has_lobes()) {
          light.earlier = earlier(density(element, local.evaluate(cosine) / local.albedo(), light.ray));
        }
        continue;
      }
      light.weight *= medium.albedo;
      if (!along && !is_flux()) {
        score += light.weight * at_collision(element, out, light.ray, depth);
      }
      if (!survives(light.weight, rng)) {
        return false;
      }
      const bool both = both_[element] && !out.empty();
      if (both) {
        score += light.weight * from_exit(element, out, light.ray, depth, rng);
      }
      const double cosine = medium.phase.sample(rng.uniform());
      light.ray = scattered(light.ray, cosine, rng);
      const double phase = both || has_lobes() ? medium.phase.evaluate(cosine) : 0.0;
      share = both ? share_of_ray(element, out, phase, light.ray) : 1.0;
      light.earlier = earlier(density(element, phase, light.ray));
    }
  }

  static double to_face(const Medium& medium, const Ray& ray, double depth) {
    return extinction(medium, ray) * (ray.z < 0.0 ? (depth - medium.tau) / ray.z : depth / ray.z);
  }

  /// The extinction along a ray, relative to that along the normal.
  static double extinction(const Medium& medium, const Ray& ray) {
    return medium.flakes ? medium.flakes->extinction(std::abs(ray.z)) : 1.0;
  }

  /// The second sample of the balance heuristic: a flight scattered backwards from one of the exit directions.
  double from_exit(std::size_t element, const Exits& out, const Ray& in, double depth, Rng& rng) const {
    const Medium& medium = this->stack().elements[element].medium;
    double choice = rng.uniform() * sum_of_shares(out);
    std::size_t chosen = 0;
    while (chosen + 1 < out.size() && choice >= out[chosen].share) {
      choice -= out[chosen++].share;
    }
    const Ray ray = scattered(out[chosen].ray, medium.phase.sample(rng.uniform()), rng);
    const double length = to_face(medium, ray, depth);
    return share_of_ray(element, out, medium.phase.evaluate(in.dot(ray)), ray) *
           on_flight(element, out, ray, depth, length, std::exp(-length));
  }

  /// The balance heuristic's weight of a direction sampled from the ray with density `from_ray`. The weight also
  /// applies to directions sampled from an exit, where the ratio of the densities cancels against the phase function.
  double share_of_ray(std::size_t element, const Exits& out, double from_ray, const Ray& ray) const {
    const PhaseFunction& phase = this->stack().elements[element].medium.phase;
    double from_exit = 0.0;
    for (const Exit& one : out) {
      from_exit += one.share * phase.evaluate(ray.dot(one.ray));
    }
    from_exit /= sum_of_shares(out);
    return from_ray > 0.0 ? from_ray / (from_ray + from_exit) : 0.0;
  }

  double leaving(std::size_t element, const Exits& out, const Ray& in) const override {
    if (!along_[element]) {
      return 0.0;
    }
    const double tau = this->stack().elements[element].medium.tau;
    const double length = tau / std::abs(in.z);
    return on_flight(element, out, in, in.z < 0.0 ? 0.0 : tau, length, std::exp(-length));
  }

  double scattered_share(std::size_t element, const Ray& in) const override {
    const Medium& medium = this->stack().elements[element].medium;
    return medium.albedo > 0.0 ? -std::expm1(-medium.tau * extinction(medium, in) / std::abs(in.z)) : 0.0;
  }

  static double sum_of_shares(const Exits& out) {
    double sum = 0.0;
    for (const Exit& one : out) {
      sum += one.share;
    }
    return sum;
  }

  /// The density of a ray into which a phase function of this value scatters, relative to n^2 times the projected solid
  /// angle.
  double density(std::size_t element, double phase, const Ray& ray) const {
    const double n = this->stack().ior[element];
    return phase / (4.0 * pi * n * n * std::abs(ray.z));
  }

  double scattering(std::size_t element, const Ray& in, const Exit& out) const {
    const double phase = this->stack().elements[element].medium.phase.evaluate(in.dot(out.ray));
    return out.weighed(density(element, phase, out.ray));
  }

  double on_flight(std::size_t element, const Exits& out, const Ray& in, double depth, double length,
                   double through) const {
    const Medium& medium = this->stack().elements[element].medium;
    double sum = 0.0;
    for (const Exit& one : out) {
      const double to_face = one.is_up() ? depth : medium.tau - depth;
      const double mu = std::abs(one.ray.z);
      const double far = medium.tau - to_face;
      const double kept = std::exp(-to_face / mu);
      const bool away = (in.z < 0.0) == one.is_up();
      const double integral = away ? flight_away(kept, std::exp(-(to_face + far) / mu), through, std::abs(in.z) / mu)
                                   : flight_towards(kept, through, to_face / mu, length);
      sum += one.share * integral * scattering(element, in, one);
    }
    return medium.albedo * sum;
  }

  double at_collision(std::size_t element, const Exits& out, const Ray& in, double depth) const {
    double sum = 0.0;
    for (const Exit& one : out) {
      sum += one.share * kept_from(element, one, depth) * scattering(element, in, one);
    }
    return sum;
  }

  /// The next event at one depth of a graded medium, albedo included.
  double at_depth(std::size_t element, const Exits& out, const Ray& in, double depth,
                  const LocalScattering& local) const {
    const double albedo = local.albedo();
    if (albedo == 0.0) {
      return 0.0;
    }
    double sum = 0.0;
    for (const Exit& one : out) {
      const double phase = local.evaluate(in.dot(one.ray)) / albedo;
      sum += one.share * kept_from(element, one, depth) * one.weighed(density(element, phase, one.ray));
    }
    return albedo * sum;
  }

  /// The next event of light that collides in a medium with flakes.
  double from_flakes(std::size_t element, const Exits& out, const FlakeScatter& flakes, double depth) const {
    double sum = 0.0;
    for (const Exit& one : out) {
      const FlakeScatter::Event event = flakes.to(one.ray);
      sum += one.share * kept_from(element, one, depth) * event.kept *
             one.weighed(density(element, event.density, one.ray));
    }
    return this->stack().elements[element].medium.albedo * sum;
  }

  /// The share of light from this depth that reaches the face where it leaves.
  double kept_from(std::size_t element, const Exit& out, double depth) const {
    return std::exp(-to_face(this->stack().elements[element].medium, out.ray, depth));
  }

  std::vector<bool> along_;  ///< by element
  std::vector<bool> both_;   ///< by element
};

/// True for a single homogeneous medium.
bool is_slab(const WalkElements& stack) {
  const auto& elements = stack.elements;
  return stack.ior.front() == 1.0 && stack.ior.back() == 1.0 && !elements.empty() &&
         elements[0].kind == Kind::kMedium && !elements[0].graded && !elements[0].medium.flakes &&
         (elements.size() == 1 ||
          (elements.size() == 2 && elements[1].kind == Kind::kLambert && elements[1].reflectance == 0.0));
}

}  // namespace

std::unique_ptr<Walk> make_transfer_walk(const Stack& stack, const WalkTarget& target, NextEvent next_event) {
  WalkElements walked(stack, target);
  if (is_slab(walked)) {
    return make_slab_walk(walked.elements[0].medium, target, next_event);
  }
  return std::make_unique<TransferWalk>(std::move(walked), target, next_event);
}

}  // namespace lamina

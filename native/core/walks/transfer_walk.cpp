// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/transfer_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "walks/flight.hpp"
#include "walks/slab_walk.hpp"
#include "walks/stack_walk.hpp"
#include "walks/survival.hpp"

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
      along_.push_back(next_event != NextEvent::kAtCollision && !element.graded);
      both_.push_back(along_.back() && fitted(next_event, element.medium.phase) == NextEvent::kFromBothEnds &&
                      !target.flux);
    }
    begin();
  }

 private:
  bool cross(std::size_t element, const Exit& out, Light& light, bool first, double& score, Rng& rng,
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
      depth = std::clamp(depth + light.ray.z * std::log(choice), 0.0, medium.tau);
      ++events;
      if (here.graded) {
        const LocalScattering local = here.graded->at_depth(depth);
        if (!is_flux()) {
          score += light.weight * at_depth(element, out, light.ray, depth, local);
        }
        light.weight *= local.albedo();
        if (!survives(light.weight, rng)) {
          return false;
        }
        light.ray = scattered(light.ray, local.sample(rng.uniform()), rng);
        continue;
      }
      light.weight *= medium.albedo;
      if (!along && !is_flux()) {
        score += light.weight * at_collision(element, out, light.ray, depth);
      }
      if (!survives(light.weight, rng)) {
        return false;
      }
      const bool both = both_[element] && out.up_share + out.down_share > 0.0;
      if (both) {
        score += light.weight * from_exit(element, out, light.ray, depth, rng);
      }
      const double cosine = medium.phase.sample(rng.uniform());
      light.ray = scattered(light.ray, cosine, rng);
      share = both ? share_of_ray(element, out, medium.phase.evaluate(cosine), light.ray) : 1.0;
    }
  }

  static double to_face(const Medium& medium, const Ray& ray, double depth) {
    return ray.z < 0.0 ? (depth - medium.tau) / ray.z : depth / ray.z;
  }

  /// The second sample of the balance heuristic: a flight scattered backwards from one of the exit directions.
  double from_exit(std::size_t element, const Exit& out, const Ray& in, double depth, Rng& rng) const {
    const Medium& medium = this->stack().elements[element].medium;
    const bool up = rng.uniform() * (out.up_share + out.down_share) < out.up_share;
    const Ray ray = scattered(up ? out.up : out.down, medium.phase.sample(rng.uniform()), rng);
    const double length = to_face(medium, ray, depth);
    return share_of_ray(element, out, medium.phase.evaluate(in.dot(ray)), ray) *
           on_flight(element, out, ray, depth, length, std::exp(-length));
  }

  /// The balance heuristic's weight of a direction sampled from the ray with density `from_ray`. The weight also
  /// applies to directions sampled from an exit, where the ratio of the densities cancels against the phase function.
  double share_of_ray(std::size_t element, const Exit& out, double from_ray, const Ray& ray) const {
    const PhaseFunction& phase = this->stack().elements[element].medium.phase;
    double from_exit = 0.0;
    if (out.up_share > 0.0) {
      from_exit += out.up_share * phase.evaluate(ray.dot(out.up));
    }
    if (out.down_share > 0.0) {
      from_exit += out.down_share * phase.evaluate(ray.dot(out.down));
    }
    from_exit /= out.up_share + out.down_share;
    return from_ray > 0.0 ? from_ray / (from_ray + from_exit) : 0.0;
  }

  double leaving(std::size_t element, const Exit& out, const Ray& in) const override {
    if (!along_[element]) {
      return 0.0;
    }
    const double tau = this->stack().elements[element].medium.tau;
    const double length = tau / std::abs(in.z);
    return on_flight(element, out, in, in.z < 0.0 ? 0.0 : tau, length, std::exp(-length));
  }

  double scattered_share(std::size_t element, const Ray& in) const override {
    const Medium& medium = this->stack().elements[element].medium;
    return medium.albedo > 0.0 ? -std::expm1(-medium.tau / std::abs(in.z)) : 0.0;
  }

  double scattering(std::size_t element, const Ray& in, const Ray& out) const {
    const double n = this->stack().ior[element];
    return this->stack().elements[element].medium.phase.evaluate(in.dot(out)) / (4.0 * pi * n * n * std::abs(out.z));
  }

  double on_flight(std::size_t element, const Exit& out, const Ray& in, double depth, double length,
                   double through) const {
    const Medium& medium = this->stack().elements[element].medium;
    double sum = 0.0;
    const auto add = [&](const Ray& ray, double share, double to_face) {
      const double mu = std::abs(ray.z);
      const double far = medium.tau - to_face;
      if (share == 0.0) {
        return;
      }
      const double kept = std::exp(-to_face / mu);
      const bool away = (in.z < 0.0) != (ray.z < 0.0);
      const double integral = away ? flight_away(kept, std::exp(-(to_face + far) / mu), through, std::abs(in.z) / mu)
                                   : flight_towards(kept, through, to_face / mu, length);
      sum += share * integral * scattering(element, in, ray);
    };
    add(out.up, out.up_share, depth);
    add(out.down, out.down_share, medium.tau - depth);
    return medium.albedo * sum;
  }

  double at_collision(std::size_t element, const Exit& out, const Ray& in, double depth) const {
    const double tau = this->stack().elements[element].medium.tau;
    double sum = 0.0;
    if (out.up_share > 0.0) {
      sum += out.up_share * std::exp(-depth / out.up.z) * scattering(element, in, out.up);
    }
    if (out.down_share > 0.0) {
      sum += out.down_share * std::exp((tau - depth) / out.down.z) * scattering(element, in, out.down);
    }
    return sum;
  }

  /// The next event at one depth of a graded medium, albedo included.
  double at_depth(std::size_t element, const Exit& out, const Ray& in, double depth,
                  const LocalScattering& local) const {
    const double n = this->stack().ior[element];
    const double tau = this->stack().elements[element].medium.tau;
    double sum = 0.0;
    const auto add = [&](const Ray& ray, double share, double to_face) {
      if (share > 0.0) {
        const double mu = std::abs(ray.z);
        sum += share * std::exp(-to_face / mu) * local.evaluate(in.dot(ray)) / mu;
      }
    };
    add(out.up, out.up_share, depth);
    add(out.down, out.down_share, tau - depth);
    return sum / (4.0 * pi * n * n);
  }

  std::vector<bool> along_;  ///< by element
  std::vector<bool> both_;   ///< by element
};

/// True for a single homogeneous medium.
bool is_slab(const WalkElements& stack) {
  const auto& elements = stack.elements;
  return stack.ior.front() == 1.0 && stack.ior.back() == 1.0 && !elements.empty() &&
         elements[0].kind == Kind::kMedium && !elements[0].graded &&
         (elements.size() == 1 ||
          (elements.size() == 2 && elements[1].kind == Kind::kLambert && elements[1].reflectance == 0.0));
}

}  // namespace

std::unique_ptr<Walk> make_transfer_walk(const Stack& stack, const WalkTarget& target, NextEvent next_event) {
  WalkElements walked(stack, target.side);
  if (is_slab(walked)) {
    return make_slab_walk(walked.elements[0].medium, target, next_event);
  }
  return std::make_unique<TransferWalk>(std::move(walked), target, next_event);
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/plain_scattering_walk.hpp"

#include <cmath>
#include <numbers>

#include "walks/branch_stack.hpp"
#include "walks/slab_ray.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// S of a slab of thickness `top` between two directions, still to be estimated.
struct Branch {
  double top;
  SlabRay a;
  SlabRay b;
};

/// Uniform over the hemisphere.
SlabRay any_direction(Rng& rng) {
  const double mu = rng.uniform();
  const double azimuth = 2.0 * pi * rng.uniform();
  const double sine = std::sqrt(1.0 - mu * mu);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
}

}  // namespace

PlainScatteringWalk::PlainScatteringWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi)
    : medium_(medium), mu_o_(mu_o), mu_i_(mu_i), dphi_(dphi) {}

double PlainScatteringWalk::sample(Rng& rng, std::uint64_t& events) const {
  double weight = 1.0 / (4.0 * pi * mu_o_ * mu_i_);
  BranchStack<Branch> waiting;
  Branch branch{medium_.tau(), SlabRay::of(mu_o_, dphi_), SlabRay::of(mu_i_, 0.0)};
  while (true) {
    ++events;
    const double s = 1.0 / branch.a.mu + 1.0 / branch.b.mu;

    // End the branch on the surface below, or continue in the slab
    if (medium_.ground() > 0.0) {
      const double odds = std::exp(-branch.top) / (2.0 - std::exp(-branch.top));
      if (rng.uniform() < odds) {
        weight *= 4.0 * branch.a.mu * branch.b.mu * medium_.ground() * std::exp(-s * branch.top) / odds;
        if (!waiting.pop(branch)) {
          return weight;
        }
        continue;
      }
      weight /= 1.0 - odds;
    }

    // Draw the height of the vertex in proportion to exp(-s (top - t))
    const double span = -std::expm1(-s * branch.top);
    const double t = std::max(0.0, branch.top + std::log1p(-span * rng.uniform()) / s);
    const LocalScattering scattering = medium_.at(t);
    const double albedo = scattering.albedo();
    weight *= span / s;

    // Choose for each side whether it continues into S, with a probability that grows with the thickness of the slab
    // below
    const double dark = (1.0 - medium_.ground()) * std::exp(-t);
    const double chance = medium_.ground() > 0.0 ? (1.0 - dark) / (2.0 - dark) : -std::expm1(-t) / (2.0 - std::exp(-t));
    const bool on_a = rng.uniform() < chance;
    const bool on_b = rng.uniform() < chance;
    weight /= (on_a ? chance : 1.0 - chance) * (on_b ? chance : 1.0 - chance);

    // Follow SkS, kS or Sk, or end with k
    if (on_a && on_b) {
      const SlabRay p = any_direction(rng);
      const SlabRay q = any_direction(rng);
      weight *= 0.25 * scattering.evaluate(turned_back(p, q)) / (p.mu * q.mu);
      waiting.push({t, q, branch.b});
      branch = {t, branch.a, p};
    } else if (on_a || on_b) {
      const SlabRay& from = on_a ? branch.a : branch.b;
      const SlabRay& other = on_a ? branch.b : branch.a;
      const SlabRay next = SlabFrame(from).turned(scattering.sample(rng.uniform()), 2.0 * pi * rng.uniform());
      if (next.mu <= 0.0) {
        return 0.0;
      }
      weight *= albedo / next.mu;
      branch = {t, next, other};
    } else {
      weight *= scattering.evaluate(turned_back(branch.a, branch.b));
      if (!waiting.pop(branch)) {
        return weight;
      }
    }
    if (weight == 0.0) {
      return 0.0;
    }
  }
}

}  // namespace lamina

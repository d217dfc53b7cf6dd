// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/residual_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "guided/height_sampling.hpp"
#include "matter/single_scattering_shape.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

// The estimate is unbiased for any of these numbers; they set its variance.

/// Least probability of a term, relative to the sum.
constexpr double kLeast = 0.02;
/// Floor of the tables' kS + Sk + SkS, relative to albedo^2 t / (1 + t).
constexpr double kFloor = 1e-3;
/// In the continuation probability, the residual R~ counts at least as this share of S.
constexpr double kLeastRest = 0.05;
/// Continuation probability of a branch with the whole residual, and least continuation probability.
constexpr double kEager = 0.6;
constexpr double kLeastOn = 0.05;

}  // namespace

/// S of a slab between two directions, still to be estimated.
struct ResidualWalk::Branch {
  double top;
  std::size_t cell;  ///< of the guide's heights
  SlabRay a;
  SlabRay b;
  double once;  ///< S1
  double rest;  ///< R~
};

ResidualWalk::ResidualWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
                           std::shared_ptr<const ScatteringGuide> guide)
    : medium_(medium),
      guide_(std::move(guide)),
      view_(SlabRay::of(mu_o, dphi)),
      light_(SlabRay::of(mu_i, 0.0)),
      directions_(*guide_, candidates),
      scattering_(medium_.at(0.0)),
      root_(medium_, *guide_, view_, light_),
      once_(scattering_.evaluate(turned_back(view_, light_)) * single_reflection(mu_o, mu_i, medium_.tau()) /
            (4.0 * pi)),
      scale_(1.0 / (4.0 * pi * mu_o * mu_i)) {
  if (!medium.is_homogeneous() || medium.ground() > 0.0) {
    throw std::invalid_argument("medium: must be homogeneous, over nothing");
  }
  // The floor is linear in t for thin slabs, as kS is, and positive where rounding leaves zero in the tables.
  const ScatteringGuide::Column& t = guide_->heights().column();
  floor_ = static_cast<float>(kFloor * scattering_.albedo() * scattering_.albedo()) * t / (1.0F + t);
}

ResidualWalk::Branch ResidualWalk::branch(const GuidedVertex& vertex, const SlabRay& a, const SlabRay& b,
                                          double value) const {
  const double once = scattering_.evaluate(turned_back(a, b)) * a.mu * b.mu * single_reflection(a.mu, b.mu, vertex.t);
  return {vertex.t, vertex.cell, a, b, once, std::max(0.0, value - once)};
}

/// Estimates S of the branch. `importance`: the factor of S in the sample, relative to R~ of the whole slab.
double ResidualWalk::estimate(Branch branch, double importance, Rng& rng, std::uint64_t& events) const {
  const GuideHeights& heights = guide_->heights();
  double sum = 0.0;
  double weight = 1.0;
  while (true) {
    // Continue with probability q, else score the tabulated residual
    const double all = branch.once + branch.rest;
    const double q = std::clamp(kEager * importance * std::max(branch.rest, kLeastRest * all), kLeastOn, 1.0);
    if (rng.uniform() >= q) {
      return sum + weight * all;
    }
    sum += weight * (all - branch.rest / q);
    weight /= q;
    importance /= q;
    ++events;

    // Draw the height of the vertex
    const SlabRay a = branch.a;
    const SlabRay b = branch.b;
    const ScatteringGuide::Terms terms(*guide_, a, b);
    const ScatteringGuide::Column source = terms.repeated() + floor_;
    const HeightSampling::Choice choice =
        HeightSampling::draw(heights, branch.top, branch.cell, 1.0 / a.mu + 1.0 / b.mu, source, rng);
    const GuidedVertex vertex{choice.t, choice.cell, heights.fraction(choice.t, choice.cell)};

    // Compute the probabilities of kS, Sk and SkS in proportion to the tables
    const double repeated = vertex.at(source);
    const double one_a = terms.one_side(vertex.cell, vertex.up, true);
    const double one_b = terms.one_side(vertex.cell, vertex.up, false);
    const double least = kLeast * repeated;
    const std::array<double, 3> mass = {std::max(one_a, least), std::max(one_b, least),
                                        std::max(repeated - one_a - one_b, least)};
    const double total = mass[0] + mass[1] + mass[2];

    // Choose a term and follow it
    const double u = rng.uniform() * total;
    double factor = choice.weight * total;
    if (u < mass[0] + mass[1]) {
      const bool first = u < mass[0];
      const GuidedDirections::Step step = directions_.one_side(vertex, scattering_, first ? a : b, first ? b : a, rng);
      factor *= step.weight / mass[first ? 0 : 1];
      if (!(factor > 0.0)) {
        return sum;
      }
      branch = this->branch(vertex, step.ray, first ? b : a, step.value);
    } else {
      const GuidedDirections::Pair pair = directions_.both_sides(vertex, scattering_, a, b, rng);
      factor *= pair.weight / mass[2];
      if (!(factor > 0.0)) {
        return sum;
      }
      const double side =
          estimate(this->branch(vertex, pair.p, a, pair.value_p), importance * factor * pair.value_q, rng, events);
      branch = this->branch(vertex, pair.q, b, pair.value_q);
      factor *= side;
    }
    weight *= factor;
    importance *= std::abs(factor);
  }
}

double ResidualWalk::sample(Rng& rng, std::uint64_t& events) const {
  // Draw the first vertex and its term from the tables of the fixed directions
  ++events;
  const FirstVertex::Choice choice = root_.draw(rng);
  if (choice.weight == 0.0) {
    return once_;
  }
  const GuidedVertex vertex{choice.t, choice.cell, choice.up};

  // Estimate S on the sides where the term continues
  const double importance = choice.weight / root_.rest();
  double rest = choice.weight;
  if (choice.term == FirstVertex::Term::kBoth) {
    const GuidedDirections::Pair pair = directions_.both_sides(vertex, scattering_, view_, light_, rng);
    if (!(pair.weight > 0.0)) {
      return once_;
    }
    const double factor = pair.weight * importance;
    const double side = estimate(branch(vertex, pair.p, view_, pair.value_p), factor * pair.value_q, rng, events);
    rest *= pair.weight * side *
            estimate(branch(vertex, pair.q, light_, pair.value_q), factor * std::abs(side), rng, events);
  } else {
    const SlabRay& other = choice.term == FirstVertex::Term::kOfA ? light_ : view_;
    const double value = guide_->value(vertex.cell, vertex.up, vertex.t, choice.ray, other, scattering_);
    rest *= estimate(branch(vertex, choice.ray, other, value), importance, rng, events);
  }
  return once_ + scale_ * rest;
}

}  // namespace lamina

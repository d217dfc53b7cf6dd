// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/isotropic_walk.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "guided/ground_end.hpp"
#include "guided/height_sampling.hpp"
#include "walks/branch_stack.hpp"

namespace lamina {
namespace {

/// S of a slab of thickness `top` between two cosines, still to be estimated.
struct Branch {
  double top;
  std::size_t cell;  ///< of the guide's heights, holds `top`
  double a;
  double b;
};

/// Least probability of either choice at a side. Bounds the weight where the tables are wrong; any value is unbiased.
constexpr double kLeast = 0.01;
/// Floor of the guide's source in a graded medium, relative to its maximum, so that every height can be sampled.
constexpr float kLeastSource = 1e-3F;

}  // namespace

IsotropicWalk::IsotropicWalk(const GradedMedium& medium, double mu_o, double mu_i)
    : medium_(medium), guide_(medium), mu_o_(mu_o), mu_i_(mu_i) {
  if (!medium.is_isotropic()) {
    throw std::invalid_argument("phase: must be isotropic");
  }
}

double IsotropicWalk::sample(Rng& rng, std::uint64_t& events) const {
  const GuideHeights& heights = guide_.heights();
  BranchStack<Branch> waiting;
  Branch branch{medium_.tau(), heights.last_cell(), mu_o_, mu_i_};
  double weight = 1.0 / (4.0 * std::numbers::pi * mu_o_ * mu_i_);
  while (true) {
    ++events;

    // Look up albedo X(mu) X(mu0) at the guide's heights
    const IsotropicGuide::Place place_a = IsotropicGuide::place(branch.a);
    const IsotropicGuide::Place place_b = IsotropicGuide::place(branch.b);
    const double s = 1.0 / branch.a + 1.0 / branch.b;
    const GuideHeights::Column escapes[2] = {guide_.escape(place_a), guide_.escape(place_b)};
    GuideHeights::Column source = guide_.albedo() * escapes[0] * escapes[1];
    if (!medium_.is_homogeneous()) {
      // Between two heights the medium may scatter although it does not scatter at either height.
      source = source.max(kLeastSource * source.maxCoeff());
    }

    // End the branch on the surface below, or continue in the slab
    if (medium_.ground() > 0.0 &&
        GroundEnd(medium_.ground(), branch.a, branch.b, heights, branch.top, source).taken(rng, weight)) {
      if (!waiting.pop(branch)) {
        return weight;
      }
      continue;
    }

    // Draw the height of the vertex
    const HeightSampling::Choice vertex = HeightSampling::draw(heights, branch.top, branch.cell, s, source, rng);
    weight *= vertex.weight * medium_.at(vertex.t).albedo();
    if (weight == 0.0) {
      return 0.0;
    }

    // Choose for each side: unscattered light, or S of the slab below
    const double up = heights.fraction(vertex.t, vertex.cell);
    bool found = false;
    const double sides[2] = {branch.a, branch.b};
    const IsotropicGuide::Place places[2] = {place_a, place_b};
    for (std::size_t k = 0; k < 2; ++k) {
      const float* column = escapes[k].data() + vertex.cell;
      const double lower = static_cast<double>(column[0]);
      const double escape = lower + up * (static_cast<double>(column[1]) - lower);
      const double straight = std::clamp(1.0 / escape, kLeast, 1.0 - kLeast);
      if (rng.uniform() < straight) {
        weight /= straight;
      } else {
        const IsotropicGuide::Direction next = guide_.draw(vertex.cell, up, places[k], rng);
        weight *= 0.5 / (next.mu * next.density * (1.0 - straight));
        if (found) {
          waiting.push(branch);
        }
        found = true;
        branch = {vertex.t, vertex.cell, next.mu, sides[k]};
      }
    }
    if (!found && !waiting.pop(branch)) {
      return weight;
    }
  }
}

}  // namespace lamina

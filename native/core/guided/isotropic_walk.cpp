// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/isotropic_walk.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "guided/ground_end.hpp"
#include "guided/height_sampling.hpp"

namespace lamina {
namespace {

/// A slab of thickness `top` (in cell `cell` of the guide) between two directions, still to be estimated.
struct Branch {
  double top;
  std::size_t cell;
  double a;
  double b;
};

constexpr double kLeast = 0.01;
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
  std::vector<Branch> waiting;
  double weight = 1.0 / (4.0 * std::numbers::pi * mu_o_ * mu_i_);
  Branch branch{medium_.tau(), heights.last_cell(), mu_o_, mu_i_};
  while (true) {
    ++events;
    const IsotropicGuide::Place place_a = IsotropicGuide::place(branch.a);
    const IsotropicGuide::Place place_b = IsotropicGuide::place(branch.b);
    const double s = 1.0 / branch.a + 1.0 / branch.b;
    const GuideHeights::Column escapes[2] = {guide_.escape(place_a), guide_.escape(place_b)};
    GuideHeights::Column source = guide_.albedo() * escapes[0] * escapes[1];
    if (!medium_.is_homogeneous()) {
      // What lies between the guide's heights may scatter where they do not.
      source = source.max(kLeastSource * source.maxCoeff());
    }
    if (medium_.ground() > 0.0) {
      const GroundEnd ground(medium_.ground(), branch.a, branch.b, heights, branch.top, source);
      if (rng.uniform() < ground.odds) {
        weight *= ground.value / ground.odds;
        if (waiting.empty()) {
          return weight;
        }
        branch = waiting.back();
        waiting.pop_back();
        continue;
      }
      weight /= 1.0 - ground.odds;
    }
    const HeightSampling::Choice vertex = HeightSampling::draw(heights, branch.top, branch.cell, s, source, rng);
    weight *= vertex.weight * medium_.at(vertex.t).albedo();
    if (weight == 0.0) {
      return 0.0;
    }

    // Each side: either light comes straight, or from S of the slab below.
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
          waiting.push_back(branch);
        }
        found = true;
        branch = {vertex.t, vertex.cell, next.mu, sides[k]};
      }
    }
    if (!found) {
      if (waiting.empty()) {
        return weight;
      }
      branch = waiting.back();
      waiting.pop_back();
    }
  }
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/guided_walk.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include "guided/ground_end.hpp"
#include "guided/height_sampling.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Least probability of a term.
constexpr double kLeast = 0.02;
/// Least of what vertices of a graded medium are taken to add, against the most.
constexpr float kLeastSource = 1e-3F;

}  // namespace

/// A slab of thickness `top`, in cell `cell` of the guide, between two directions, still to be estimated.
struct GuidedWalk::Branch {
  double top;
  std::size_t cell;
  SlabRay a;
  SlabRay b;
};

GuidedWalk::GuidedWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
                       std::shared_ptr<const ScatteringGuide> guide)
    : medium_(medium),
      guide_(std::move(guide)),
      view_(SlabRay::of(mu_o, dphi)),
      light_(SlabRay::of(mu_i, 0.0)),
      directions_(*guide_, candidates) {}

double GuidedWalk::sample(Rng& rng, std::uint64_t& events) const {
  const GuideHeights& heights = guide_->heights();
  std::vector<Branch> waiting;
  double weight = 1.0 / (4.0 * pi * view_.mu * light_.mu);
  Branch branch{medium_.tau(), heights.last_cell(), view_, light_};
  const bool homogeneous = medium_.is_homogeneous();
  while (true) {
    ++events;
    const SlabRay a = branch.a;
    const SlabRay b = branch.b;
    const double cosine = turned_back(a, b);
    const ScatteringGuide::Terms terms(*guide_, a, b);
    const double plain = homogeneous ? medium_.at(0.0).evaluate(cosine) : 0.0;
    const ScatteringGuide::Column repeated_column = terms.repeated();
    ScatteringGuide::Column source = repeated_column + static_cast<float>(plain);
    if (!homogeneous) {
      for (std::size_t j = 0; j <= branch.cell + 1; ++j) {
        source[static_cast<Eigen::Index>(j)] += static_cast<float>(medium_.at(heights[j]).evaluate(cosine));
      }
      // What lies between the guide's heights may scatter where they do not.
      source = source.max(kLeastSource * source.maxCoeff());
    }
    if (medium_.ground() > 0.0) {
      const GroundEnd ground(medium_.ground(), a.mu, b.mu, heights, branch.top, source);
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
    const HeightSampling::Choice choice =
        HeightSampling::draw(heights, branch.top, branch.cell, 1.0 / a.mu + 1.0 / b.mu, source, rng);
    weight *= choice.weight;
    const GuidedVertex vertex{choice.t, choice.cell, heights.fraction(choice.t, choice.cell)};
    const LocalScattering scattering = medium_.at(choice.t);

    if (scattering.albedo() == 0.0) {
      return 0.0;
    }

    // One term, in proportion to the tables.
    const double k = homogeneous ? plain : scattering.evaluate(cosine);
    const auto low = static_cast<double>(repeated_column[static_cast<Eigen::Index>(vertex.cell)]);
    const auto high = static_cast<double>(repeated_column[static_cast<Eigen::Index>(vertex.cell + 1)]);
    const double repeated = low + vertex.up * (high - low);
    const double one_a = terms.one_side(vertex.cell, vertex.up, true);
    const double one_b = terms.one_side(vertex.cell, vertex.up, false);
    const double both = std::max(0.0, repeated - one_a - one_b);
    const double least = kLeast * (k + one_a + one_b + both);
    const double weights[4] = {std::max(k, least), std::max(one_a, least), std::max(one_b, least),
                               std::max(both, least)};
    const double all = weights[0] + weights[1] + weights[2] + weights[3];
    const double u = rng.uniform();
    bool ended = false;
    const double odds[3] = {weights[0] / all, weights[1] / all, weights[2] / all};
    if (u < odds[0]) {
      weight *= k / odds[0];
      ended = true;
    } else if (u < odds[0] + odds[1] + odds[2]) {
      const bool first = u < odds[0] + odds[1];
      const GuidedDirections::Step step = directions_.one_side(vertex, scattering, first ? a : b, first ? b : a, rng);
      weight *= step.weight / (first ? odds[1] : odds[2]);
      branch = {vertex.t, vertex.cell, step.ray, first ? b : a};
    } else {
      const GuidedDirections::Pair pair = directions_.both_sides(vertex, scattering, a, b, rng);
      weight *= all / weights[3] * pair.weight;
      branch = {vertex.t, vertex.cell, pair.p, a};
      waiting.push_back({vertex.t, vertex.cell, pair.q, b});
    }
    if (weight == 0.0) {
      return 0.0;
    }
    if (ended) {
      if (waiting.empty()) {
        return weight;
      }
      branch = waiting.back();
      waiting.pop_back();
    }
  }
}

}  // namespace lamina

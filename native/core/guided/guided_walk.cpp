// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/guided_walk.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "guided/ground_end.hpp"
#include "guided/height_sampling.hpp"
#include "walks/branch_stack.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Least probability of a term. Bounds the weight of a term that the tables miss; any value is unbiased.
constexpr double kLeast = 0.02;
/// Floor of the guide's source in a graded medium, relative to its maximum, so that every height can be sampled.
constexpr float kLeastSource = 1e-3F;

}  // namespace

/// S of a slab of thickness `top` between two directions, still to be estimated.
struct GuidedWalk::Branch {
  double top;
  std::size_t cell;  ///< of the guide's heights, holds `top`
  SlabRay a;
  SlabRay b;
};

/// The tables' values for one branch.
struct GuidedWalk::Guidance {
  ScatteringGuide::Terms terms;
  double cosine;                     ///< of single scattering
  double single;                     ///< k, of a homogeneous medium
  ScatteringGuide::Column repeated;  ///< kS + Sk + SkS at the guide's heights
  ScatteringGuide::Column source;    ///< k + kS + Sk + SkS
};

GuidedWalk::GuidedWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
                       std::shared_ptr<const ScatteringGuide> guide)
    : medium_(medium),
      guide_(std::move(guide)),
      view_(SlabRay::of(mu_o, dphi)),
      light_(SlabRay::of(mu_i, 0.0)),
      directions_(*guide_, candidates) {}

GuidedWalk::Guidance GuidedWalk::guidance(const Branch& branch) const {
  const GuideHeights& heights = guide_->heights();
  const bool homogeneous = medium_.is_homogeneous();
  const ScatteringGuide::Terms terms(*guide_, branch.a, branch.b);
  const double cosine = turned_back(branch.a, branch.b);
  const double single = homogeneous ? medium_.at(0.0).evaluate(cosine) : 0.0;
  const ScatteringGuide::Column repeated = terms.repeated();
  ScatteringGuide::Column source = repeated + static_cast<float>(single);
  if (!homogeneous) {
    for (std::size_t j = 0; j <= branch.cell + 1; ++j) {
      source[static_cast<Eigen::Index>(j)] += static_cast<float>(medium_.at(heights[j]).evaluate(cosine));
    }
    // Between two heights the medium may scatter although it does not scatter at either height.
    source = source.max(kLeastSource * source.maxCoeff());
  }
  return {terms, cosine, single, repeated, source};
}

double GuidedWalk::sample(Rng& rng, std::uint64_t& events) const {
  const GuideHeights& heights = guide_->heights();
  BranchStack<Branch> waiting;
  Branch branch{medium_.tau(), heights.last_cell(), view_, light_};
  double weight = 1.0 / (4.0 * pi * view_.mu * light_.mu);
  while (true) {
    ++events;
    const SlabRay a = branch.a;
    const SlabRay b = branch.b;
    const Guidance guidance = this->guidance(branch);

    // End the branch on the surface below, or continue in the slab
    if (medium_.ground() > 0.0 &&
        GroundEnd(medium_.ground(), a.mu, b.mu, heights, branch.top, guidance.source).taken(rng, weight)) {
      if (!waiting.pop(branch)) {
        return weight;
      }
      continue;
    }

    // Draw the height of the vertex
    const HeightSampling::Choice choice =
        HeightSampling::draw(heights, branch.top, branch.cell, 1.0 / a.mu + 1.0 / b.mu, guidance.source, rng);
    weight *= choice.weight;
    const GuidedVertex vertex{choice.t, choice.cell, heights.fraction(choice.t, choice.cell)};
    const LocalScattering scattering = medium_.at(choice.t);
    if (scattering.albedo() == 0.0) {
      return 0.0;
    }

    // Compute the probabilities of k, kS, Sk and SkS in proportion to the tables
    const double k = medium_.is_homogeneous() ? guidance.single : scattering.evaluate(guidance.cosine);
    const double repeated = vertex.at(guidance.repeated);
    const double one_a = guidance.terms.one_side(vertex.cell, vertex.up, true);
    const double one_b = guidance.terms.one_side(vertex.cell, vertex.up, false);
    const double both = std::max(0.0, repeated - one_a - one_b);
    const double least = kLeast * (k + one_a + one_b + both);
    const std::array<double, 4> mass = {std::max(k, least), std::max(one_a, least), std::max(one_b, least),
                                        std::max(both, least)};
    const double all = mass[0] + mass[1] + mass[2] + mass[3];
    const std::array<double, 3> odds = {mass[0] / all, mass[1] / all, mass[2] / all};

    // Choose a term and follow its branches
    const double u = rng.uniform();
    const bool ended = u < odds[0];
    if (ended) {
      weight *= k / odds[0];
    } else if (u < odds[0] + odds[1] + odds[2]) {
      const bool first = u < odds[0] + odds[1];
      const GuidedDirections::Step step = directions_.one_side(vertex, scattering, first ? a : b, first ? b : a, rng);
      weight *= step.weight / (first ? odds[1] : odds[2]);
      branch = {vertex.t, vertex.cell, step.ray, first ? b : a};
    } else {
      const GuidedDirections::Pair pair = directions_.both_sides(vertex, scattering, a, b, rng);
      weight *= all / mass[3] * pair.weight;
      branch = {vertex.t, vertex.cell, pair.p, a};
      waiting.push({vertex.t, vertex.cell, pair.q, b});
    }
    if (weight == 0.0) {
      return 0.0;
    }
    if (ended && !waiting.pop(branch)) {
      return weight;
    }
  }
}

}  // namespace lamina

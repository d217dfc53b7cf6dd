// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/moments_behind_lobes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using std::numbers::pi;

/// The spectrum of a GGX lobe at k times its inverse width, from above: k K_1(k) < sqrt(1 + pi k / 2) exp(-k).
double blurred(double k) { return std::sqrt(1.0 + 0.5 * pi * k) * std::exp(-k); }

/// The number of moments that represent a medium's phase function, blurred by a lobe of this width in radians, within
/// the relative error `tolerance` of the light that the medium scatters once, at all angles.
int moments_needed(const PhaseFunction& phase, const TruncatedMedium& medium, double width, double tolerance) {
  constexpr Index kAngles = 361;
  constexpr double kFaint = 1e-3;  // in 1/sr; smaller values may have the error of this one
  constexpr double kLeast = 0.05;  // the tolerance holds for larger cosines
  const ArrayXd cosines = ArrayXd::LinSpaced(kAngles, 0.0, pi).cos();
  ArrayXd allowed = cosines;
  phase.evaluate_all(allowed);
  // The largest light in 1/sr of a phase function of 1: thin media scatter in proportion to their thickness.
  const double brightest =
      0.25 / pi * medium.single_scattering_albedo() * std::min(medium.tau / (kLeast * kLeast), 0.5 / kLeast);
  allowed = tolerance * allowed.max(std::max(0.02, kFaint / brightest));
  // Legendre polynomials upwards, then the rest of the series downwards.
  std::vector<ArrayXd> terms;
  ArrayXd before = ArrayXd::Zero(kAngles);
  ArrayXd now = ArrayXd::Ones(kAngles);
  for (int l = 0; l <= kMostMoments; ++l) {
    terms.emplace_back((2.0 * l + 1.0) * phase.moment(l) * blurred(l * width) * now);
    const ArrayXd next = ((2.0 * l + 1.0) * cosines * now - static_cast<double>(l) * before) / (l + 1.0);
    before = now;
    now = next;
  }
  ArrayXd rest = ArrayXd::Zero(kAngles);
  int needed = kMostMoments;
  while (needed > 0) {
    rest += terms[static_cast<std::size_t>(needed)];
    if ((rest.abs() > allowed).any()) {
      break;
    }
    --needed;
  }
  return needed;
}

/// The narrowest lobe of the rough boundaries next to a medium, in radians there.
double narrowest_lobe(const Solution& solution, const Solution::Scatterer& scatterer) {
  const Stack& stack = solution.stack();
  const std::vector<double> indices = refractive_indices(stack);
  const std::size_t own = section_of(solution, scatterer.layer);
  double narrowest = 1e300;
  for (std::size_t k = own > 0 ? own - 1 : 0; k < std::min(own + 1, solution.boundaries().size()); ++k) {
    const Solution::Boundary& boundary = solution.boundaries()[k];
    const bool at_base = boundary.layer == stack.layers.size();
    const Facets& facets = at_base ? stack.base.facets : std::get<Interface>(stack.layers[boundary.layer]).facets;
    const double reflected = 2.0 * indices[boundary.layer];
    const double turn =
        at_base ? reflected : std::min(reflected, std::abs(indices[boundary.layer + 1] - indices[boundary.layer]));
    narrowest = std::min(narrowest, turn * facets.alpha / scatterer.ior);
  }
  return narrowest;
}

}  // namespace

std::size_t section_of(const Solution& solution, std::size_t layer) {
  std::size_t section = 0;
  while (section < solution.boundaries().size() && solution.boundaries()[section].layer < layer) {
    ++section;
  }
  return section;
}

int moments_behind_lobes(const Solution& solution, const Solution::Scatterer& scatterer, double tolerance) {
  return moments_needed(scatterer.phase, scatterer.medium, narrowest_lobe(solution, scatterer), tolerance);
}

}  // namespace lamina

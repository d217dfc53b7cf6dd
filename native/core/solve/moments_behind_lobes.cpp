// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/moments_behind_lobes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "phase/moments_needed.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// The spectrum of a GGX lobe at k times its inverse width, from above: k K_1(k) < sqrt(1 + pi k / 2) exp(-k).
double blurred(double k) { return std::sqrt(1.0 + 0.5 * pi * k) * std::exp(-k); }

/// The largest light in 1/sr of a phase function of 1: thin media scatter in proportion to their thickness.
double brightest(const TruncatedMedium& medium) {
  constexpr double kLeast = 0.05;  // the tolerance holds for larger cosines
  return 0.25 / pi * medium.single_scattering_albedo() * std::min(medium.tau / (kLeast * kLeast), 0.5 / kLeast);
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
  constexpr double kFaint = 1e-3;  // in 1/sr; smaller values may have the error of this one
  const double width = narrowest_lobe(solution, scatterer);
  return moments_needed(scatterer.phase, tolerance, std::max(0.02, kFaint / brightest(scatterer.medium)),
                        [&](int l) { return blurred(l * width); });
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
#include "resolution.hpp"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

constexpr int kMostNodes = 160;
constexpr int kStep = 8;

int rounded_up(double nodes) { return static_cast<int>(std::ceil(nodes / kStep)) * kStep; }

}  // namespace

Resolution choose_resolution(const Stack& stack, double tolerance) {
  double peak = 0.0;
  for (const Medium& medium : stack.layers) {
    if (medium.albedo > 0.0 && medium.tau > 0.0) {
      peak = std::max(peak, medium.phase.peak());
    }
  }
  // Measured: 32 nodes hold 1e-4 for peaks up to .8, and thin layers down to tau = .001 within 1e-3;
  // beyond that, |chi_2n| near 1e-3 of the tolerance keeps the error of truncation below it.
  const double smooth = tolerance < 5e-3 ? 32.0 : 16.0;
  const double peaked = peak > 0.0 ? std::log(1e-3 * tolerance) / (2.0 * std::log(peak)) : 0.0;
  Resolution resolution;
  resolution.nodes = std::clamp(rounded_up(std::max(smooth, peaked)), 16, kMostNodes);
  resolution.tolerance = tolerance;
  resolution.azimuth_tolerance = 0.03 * tolerance;
  return resolution;
}

Resolution refined(const Resolution& resolution) {
  Resolution finer = resolution;
  finer.nodes = std::min(kMostNodes, rounded_up(1.4 * resolution.nodes));
  return finer;
}

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Light that the visible normals along a chord of their disk reflect, for albedos of tilted lobes.
#pragma once
#include <algorithm>

#include "numeric/quadrature.hpp"

namespace lamina {

/// The length, of at most 2, of the part of a chord whose light is above both horizons, and the sum of the light over
/// the nodes of this part.
struct ChordLight {
  double length = 0.0;
  double sum = 0.0;
};

/// Nodes on each axis of the disk of visible normals, in [-1, 1].
inline const Quadrature& disk_rule() {
  static const Quadrature rule(24, -1.0, 1.0);
  return rule;
}

/// `reflected(along)`: the share of light that the normal at `along` in [-1, 1] reflects unmasked, at most 0 if the
/// light is below a horizon.
template <typename Reflected>
ChordLight chord_light(const Reflected& reflected) {
  constexpr int kScan = 20;
  constexpr int kBisections = 20;
  double first = 2.0;
  double last = -2.0;
  for (int k = 0; k <= kScan; ++k) {
    const double along = 2.0 * k / kScan - 1.0;
    if (reflected(along) > 0.0) {
      first = std::min(first, along);
      last = std::max(last, along);
    }
  }
  if (first > last) {
    return {};
  }
  const auto edge = [&](double inside, double outside) {
    if (reflected(outside) > 0.0) {
      return outside;
    }
    for (int k = 0; k < kBisections; ++k) {
      const double middle = 0.5 * (inside + outside);
      (reflected(middle) > 0.0 ? inside : outside) = middle;
    }
    return inside;
  };
  first = edge(first, std::max(-1.0, first - 2.0 / kScan));
  last = edge(last, std::min(1.0, last + 2.0 / kScan));
  const Quadrature& rule = disk_rule();
  double sum = 0.0;
  for (Eigen::Index k = 0; k < rule.mu.size(); ++k) {
    sum += rule.weight[k] * std::max(0.0, reflected(0.5 * (first + last) + 0.5 * (last - first) * rule.mu[k]));
  }
  return {last - first, sum};
}

}  // namespace lamina

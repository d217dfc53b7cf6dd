// SPDX-License-Identifier: GPL-3.0-or-later
// Azimuths of several sampling candidates, in a lattice by the golden ratio.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lamina {

/// Azimuths of several candidates by the golden ratio, to be turned by a random angle: with cosines in equal steps of
/// their probability they form a lattice.
template <std::size_t kCount>
struct AzimuthLattice {
  std::array<double, kCount> cosine;
  std::array<double, kCount> sine;

  AzimuthLattice() {
    for (std::size_t k = 0; k < kCount; ++k) {
      const double turn = 2.0 * std::numbers::pi * static_cast<double>(k) / std::numbers::phi;
      cosine[k] = std::cos(turn);
      sine[k] = std::sin(turn);
    }
  }
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Azimuths of a golden-ratio lattice of directions.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lamina {

/// Azimuths at multiples of the golden ratio. With cosines in equal steps of probability, and rotated by a random
/// angle, they form a lattice of directions.
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

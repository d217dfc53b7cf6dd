// SPDX-License-Identifier: GPL-3.0-or-later
// Coefficients of scattering and absorption in a grid of voxels.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "interior/channels.hpp"
#include "interior/place.hpp"

namespace lamina {

/// A homogeneous material: coefficients in 1/mm and the parameter g of the Henyey-Greenstein phase function.
struct EndMaterial {
  Channels scattering = {};
  Channels absorption = {};
  float g = 0.0F;
};

/// The number of voxels of a grid, and the box in mm that the voxels fill.
struct GridFrame {
  std::array<int, 3> voxels = {1, 1, 1};
  std::array<double, 3> low = {0.0, 0.0, 0.0};
  std::array<double, 3> high = {1.0, 1.0, 1.0};
  /// True: coefficients are interpolated trilinearly between voxel centres. False: constant in each voxel.
  bool smooth = true;
};

/// Scattering and absorption coefficients in a box. Outside the box, the values at its faces are used. The voxels are
/// not copied: they must outlive the grid. A voxel is either
///   six halves: scattering of red, green, blue, then absorption; or
///   a mixture coordinate: 0 is the first and 65535 the last end material of a palette, linear between neighbours.
/// Voxels are stored in the order [x][y][z], z fastest.
class CoefficientGrid {
 public:
  static CoefficientGrid of_halves(const GridFrame& frame, const std::uint16_t* voxels, float g);
  static CoefficientGrid of_mixture(const GridFrame& frame, const std::uint16_t* voxels,
                                    std::vector<EndMaterial> palette);

  /// Coefficients at one position. The scattering is divided between two phase functions.
  struct Sample {
    Channels scattering;
    Channels extinction;
    float g_first;
    float g_second;
    Channels second;  ///< share of the scattering with the second phase function; not set if both are equal
  };

  /// Coefficients at a position. In a smooth grid this is a stochastic lookup: one of the eight nearest voxels is drawn
  /// with its trilinear weight as probability, so the expected value is the trilinear interpolation. Delta tracking
  /// stays unbiased, because the acceptance probability is linear in the coefficients.
  Sample at(const Place& place, Rng& rng) const {
    std::array<double, 3> u = {(place.x - low_[0]) * per_mm_[0], (place.y - low_[1]) * per_mm_[1],
                               (place.z - low_[2]) * per_mm_[2]};
    if (smooth_) {
      constexpr std::uint64_t kMask = (1U << 21U) - 1U;
      constexpr double kStep = 0x1.0p-21;
      const std::uint64_t bits = rng.bits();
      u[0] += static_cast<double>(bits >> 43U) * kStep - 0.5;
      u[1] += static_cast<double>((bits >> 22U) & kMask) * kStep - 0.5;
      u[2] += static_cast<double>((bits >> 1U) & kMask) * kStep - 0.5;
    }
    std::size_t index = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double last = voxels_[axis] - 1;
      const auto cell = static_cast<std::size_t>(std::clamp(u[axis], 0.0, last));
      index = index * static_cast<std::size_t>(voxels_[axis]) + cell;
    }
    return voxel(index);
  }

  /// Bricks have kBrick voxels along each axis.
  static constexpr int kBrick = 8;
  const std::array<int, 3>& bricks() const { return bricks_; }
  const std::array<double, 3>& low() const { return low_; }
  /// Bricks per mm along each axis.
  const std::array<double, 3>& bricks_per_mm() const { return bricks_per_mm_; }
  /// True if the channels have the same extinction everywhere, to half a per cent, and one phase function.
  bool is_grey() const { return is_grey_; }
  /// The largest extinction in a brick, in 1/mm, of one channel, or of all for `channel` = kChannels.
  double majorant(const std::array<int, 3>& brick, std::size_t channel) const {
    const Majorants& found = majorants_[(static_cast<std::size_t>(brick[0]) * static_cast<std::size_t>(bricks_[1]) +
                                         static_cast<std::size_t>(brick[1])) *
                                            static_cast<std::size_t>(bricks_[2]) +
                                        static_cast<std::size_t>(brick[2])];
    return static_cast<double>(found[channel]);
  }

 private:
  CoefficientGrid(const GridFrame& frame, const std::uint16_t* voxels, std::vector<EndMaterial> palette, float g);
  void find_majorants();

  /// By channel, then of all channels.
  using Majorants = std::array<float, kChannels + 1>;

  /// Converts a half to a float. The half must be finite and not negative, but may be -0.
  static float half(std::uint16_t bits) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits & 0x7fffU) << 13U) * 0x1.0p112F;
  }

  Sample voxel(std::size_t index) const {
    if (palette_.empty()) {
      return of_half(data_ + 6 * index);
    }
    return mixture(data_[index]);
  }

  Sample of_half(const std::uint16_t* values) const {
    Sample sample;
    for (std::size_t c = 0; c < kChannels; ++c) {
      sample.scattering[c] = half(values[c]);
      sample.extinction[c] = sample.scattering[c] + half(values[3 + c]);
    }
    sample.g_first = sample.g_second = g_;
    return sample;
  }

  Sample mixture(std::uint16_t coordinate) const {
    const float place = static_cast<float>(coordinate) * palette_step_;
    const std::size_t first = std::min(static_cast<std::size_t>(place), palette_.size() - 2);
    const float share = place - static_cast<float>(first);
    const EndMaterial& a = palette_[first];
    const EndMaterial& b = palette_[first + 1];
    Sample sample;
    sample.g_first = a.g;
    sample.g_second = b.g;
    for (std::size_t c = 0; c < kChannels; ++c) {
      const float of_second = share * b.scattering[c];
      sample.scattering[c] = (1.0F - share) * a.scattering[c] + of_second;
      sample.extinction[c] = sample.scattering[c] + (1.0F - share) * a.absorption[c] + share * b.absorption[c];
      sample.second[c] = sample.scattering[c] > 0.0F ? of_second / sample.scattering[c] : 0.0F;
    }
    return sample;
  }

  std::array<int, 3> voxels_;
  std::array<double, 3> low_;
  std::array<double, 3> per_mm_;  ///< voxels
  bool smooth_;
  const std::uint16_t* data_;
  std::vector<EndMaterial> palette_;  ///< at least two materials, or empty
  float palette_step_ = 0.0F;
  float g_;
  std::array<int, 3> bricks_;
  std::array<double, 3> bricks_per_mm_;
  std::vector<Majorants> majorants_;
  bool is_grey_ = true;
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// The importance of a collision for the viewer, tabulated from the adjoint problem, for guided transfer walks.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "matter/graded_medium.hpp"
#include "walks/sphere.hpp"

namespace lamina {

/// Approximate importance, for a viewer above, of a collision in a homogeneous slab: the light that reaches the viewer
/// after at least one more collision. It is a function of the depth of the collision and of the direction of the light
/// before it, and equals the source function of the adjoint problem: by reciprocity, the source function of the diffuse
/// light of a beam from the viewer. It is computed from coarse solutions of the layers above and below. In these units
/// the next event is k exp(-depth / mu_o).
///
/// The table is linear between its points, which are uniform in log(1 + depth / unit), in sqrt(1 - |mu|) on both sides
/// of the horizon, and in sin(dphi / 2).
class AdjointSource {
 public:
  /// `out`: the direction to the viewer, upwards.
  AdjointSource(const GradedMedium& medium, const Ray& out);

  /// For depths in [0, tau] and directions of travel, arrays of one size. Positive unless the whole section is zero.
  template <typename Values>
  Values operator()(const Values& depth, const Values& x, const Values& y, const Values& z) const {
    constexpr auto kScale = static_cast<float>(kCells);
    const Values height = ((1.0F + depth * inverse_unit_).log() * cells_per_log_).min(kLastDepth).max(0.0F);
    const Values root = kScale * (1.0F - z.abs()).max(0.0F).sqrt();
    const Values place = (z < 0.0F).select(root, 2.0F * kScale - root).min(2.0F * kScale - 1e-3F);
    const Values sine = (1.0F - z * z).max(1e-12F).sqrt();
    const Values along = (x * across_x_ + y * across_y_) / sine;
    const Values azimuth = (kScale * (0.5F - 0.5F * along).max(0.0F).min(1.0F).sqrt()).min(kScale - 1e-3F);
    Values value;
    for (Eigen::Index k = 0; k < value.size(); ++k) {
      const int j = static_cast<int>(height[k]);
      const int i = static_cast<int>(place[k]);
      const int a = static_cast<int>(azimuth[k]);
      const float f = azimuth[k] - static_cast<float>(a);
      const float g = place[k] - static_cast<float>(i);
      const float* row = &table_[(static_cast<std::size_t>(j) * kCosines + static_cast<std::size_t>(i)) * kAzimuths +
                                 static_cast<std::size_t>(a)];
      const auto section = [&](const float* at) {
        const float low = at[0] + f * (at[1] - at[0]);
        const float high = at[kAzimuths] + f * (at[kAzimuths + 1] - at[kAzimuths]);
        return low + g * (high - low);
      };
      const float upper = section(row);
      value[k] = upper + (height[k] - static_cast<float>(j)) * (section(row + kCosines * kAzimuths) - upper);
    }
    return value;
  }

 private:
  struct Tabulation;

  double add_order(const Tabulation& tabulation, int m);

  // Sizes of the table. The walk is unbiased for any of them; finer tables take longer to fill.
  static constexpr std::size_t kCells = 12;  // in each hemisphere of mu, and in half a turn of azimuth
  static constexpr std::size_t kCosines = 2 * kCells + 1;
  static constexpr std::size_t kAzimuths = kCells + 1;
  static constexpr std::size_t kDepths = 20;
  static constexpr float kLastDepth = static_cast<float>(kDepths - 1) - 1e-4F;

  float across_x_;
  float across_y_;
  float inverse_unit_;
  float cells_per_log_;
  std::vector<float> table_;  // [depth, cosine, azimuth]
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// The worth of a collision to the viewer, tabulated from the adjoint problem, for guided transfer walks.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "matter/graded_medium.hpp"
#include "walks/sphere.hpp"

namespace lamina {

/// What a collision in a homogeneous slab, at some depth and of light that travels in some direction, is nearly worth
/// to a viewer above beyond its own next event: the source function of the adjoint problem. By reciprocity that is
/// the one which a beam from the viewer brings about by its diffuse light, known from the coarse solutions of the
/// layers above and below. In units in which the next event's worth is k exp(-depth / mu_o).
///
/// Linear between depths that become denser towards the top, points uniform in sqrt(1 - |mu|) on both sides of the
/// horizon, and in sin(dphi / 2).
class AdjointSource {
 public:
  /// `out`: the direction to the viewer, upwards.
  AdjointSource(const GradedMedium& medium, const Ray& out);

  /// For depths from 0 to tau and directions of travel, all of one size. Above 0 wherever anything comes.
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
  static constexpr std::size_t kCells = 12;  // of a quarter turn of elevation, and of half a turn of azimuth
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

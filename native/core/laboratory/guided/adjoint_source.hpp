// SPDX-License-Identifier: GPL-3.0-or-later
// The importance of a collision for the viewer, tabulated from the adjoint problem, for guided transfer walks.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "events/sphere.hpp"
#include "matter/graded_medium.hpp"

namespace lamina {

/// Approximate importance, for a viewer above, of a collision in a slab: the light that reaches the viewer after at
/// least one more collision or reflection by the ground. It is a function of the depth of the collision and of the
/// direction of the light before it, and equals the source function of the adjoint problem: by reciprocity, the source
/// function of the diffuse light of a beam from the viewer. It is computed from coarse solutions of the layers above
/// and below. In these units the next event is k exp(-depth / mu_o).
///
/// The table is linear between its points, which are uniform in sqrt(1 - |mu|) on both sides of the horizon, and in
/// sin(dphi / 2). Depths are uniform in log(1 + depth / unit) in a homogeneous medium; those of a graded one include
/// its knots (GuideHeights).
class AdjointSource {
 public:
  /// `out`: the direction to the viewer, upwards.
  AdjointSource(const GradedMedium& medium, const Ray& out);

  /// For depths in [0, tau] and directions of travel, arrays of one size. Positive unless the whole section is zero.
  template <typename Values>
  Values operator()(const Values& depth, const Values& x, const Values& y, const Values& z) const {
    constexpr auto kScale = static_cast<float>(kCells);
    const Values cells = cells_per_log_ > 0.0F ? Values((1.0F + depth * kInverseUnit).log() * cells_per_log_)
                                               : Values(depth.unaryExpr([this](float d) { return cell_of(d); }));
    const Values height = cells.min(last_depth_).max(0.0F);
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

  /// The same for light that reaches the ground.
  double of_ground() const { return ground_; }
  /// The depths of the table, from 0.
  const std::vector<double>& depths() const { return depths_; }

 private:
  struct Tabulation;

  /// The number of the cell of depths, and the fraction of the cell above the depth.
  float cell_of(float depth) const {
    const auto below = std::upper_bound(depths_.begin() + 1, depths_.end() - 1, static_cast<double>(depth));
    const double above = *(below - 1);
    return static_cast<float>(static_cast<double>(below - depths_.begin() - 1) +
                              (static_cast<double>(depth) - above) / (*below - above));
  }

  double add_order(const Tabulation& tabulation, int m);

  // Sizes of the table. The walk is unbiased for any of them; finer tables take longer to fill.
  static constexpr std::size_t kCells = 12;  // in each hemisphere of mu, and in half a turn of azimuth
  static constexpr std::size_t kCosines = 2 * kCells + 1;
  static constexpr std::size_t kAzimuths = kCells + 1;
  static constexpr std::size_t kDepths = 20;  // of a homogeneous medium
  /// Below this optical depth the depths of the table are about uniform, above they form a geometric sequence.
  static constexpr double kUnit = 0.05;
  static constexpr auto kInverseUnit = static_cast<float>(1.0 / kUnit);

  float across_x_;
  float across_y_;
  float cells_per_log_ = 0.0F;  // 0 in a graded medium
  float last_depth_;
  double ground_ = 0.0;
  std::vector<double> depths_;
  std::vector<float> table_;  // [depth, cosine, azimuth]
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Weighted means and regressions over a window around each point of a map.
#pragma once
#include <cstddef>
#include <cstdint>

#include "numeric/thread_pool.hpp"

namespace lamina {

/// The weighted neighbours of each point. In all arrays the values of all points for one neighbour lie together.
struct Window {
  std::size_t points = 0;
  std::size_t neighbours = 0;             ///< of a point
  const std::int32_t* numbers = nullptr;  ///< [neighbour, point]; below 0 where there is none
  const float* weights = nullptr;         ///< [neighbour, point], or [neighbour] if `is_uniform`
  const float* places = nullptr;          ///< [neighbour, point, 2], or [neighbour, 2]: along two tangents
  bool is_uniform = false;                ///< weights and places are the same for all points
};

/// Numbers of points, row after row.
struct PointValues {
  const double* data = nullptr;
  std::size_t columns = 0;
};

/// `found` [point, column]: the weighted mean of `values` over the window of each point.
void window_mean(const Window& window, const PointValues& values, double* found, ThreadPool& pool);

constexpr std::size_t kMostGuides = 5;

/// A linear regression in the window of each point explains `values` by a constant, the place, and the differences
/// between the neighbour's `guides` and those of the point. `ridge`: added to the diagonal but for the constant,
/// relative to the sum of weights. `fit` [point, column]: the regression at the point; `leverage` [point]: the share of
/// the point's own value in its fit. At most kMostGuides guides.
void window_regression(const Window& window, const PointValues& guides, const PointValues& values, double ridge,
                       double* fit, double* leverage, ThreadPool& pool);

}  // namespace lamina

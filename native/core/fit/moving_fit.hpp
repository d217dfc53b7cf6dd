// SPDX-License-Identifier: GPL-3.0-or-later
// Fits the shapes of lobes that move with the view: width, anisotropy and tilt of each lobe at each view.
//
// Weights are linear: for given shapes, they are the non-negative fit of each channel with the lobes and some broad
// closures (variable projection, Golub and Pereyra 1973). The shapes minimise what that fit leaves, by the method of
// Levenberg and Marquardt. A penalty on the distance to the shapes at neighbouring views keeps shapes continuous.
#pragma once

#include "fit/moving_lobe.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace lamina {

/// The slices of one view.
struct ViewSlices {
  double mu_o = 1.0;
  Eigen::MatrixXd broad;   ///< [light, closure]: broad closures that the lobes are fitted with
  Eigen::MatrixXd slices;  ///< [light, channel]: f * |cos theta_i|
};

struct MovingFitOptions {
  int lobes = 2;
  double stiffness = 0.02;  ///< of the penalty on the distance to the neighbours' shapes
  int iterations = 8;       ///< at most, of one view
};

/// Shapes of all lobes of one view.
using LobeShapes = std::vector<LobeShape>;
/// Runs body(0), ..., body(count - 1) in any order, perhaps on several threads, and waits for all.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& body)>;

/// Shapes [row][view] for rows of similar stacks, each with views in order from the normal outwards. The fit begins
/// with the row that lobes improve most. Its views begin with the shapes of the view before; those of the other rows
/// with the shapes of the neighbouring row. `first_row`: known shapes of the first row, with which the fit begins, or
/// none.
[[nodiscard]] std::vector<std::vector<LobeShapes>> fit_moving_lobes(
    std::span<const std::vector<ViewSlices>> rows, const LightDirections& light, const Eigen::VectorXd& solid_angle,
    const MovingFitOptions& options, const ForEach& for_each, std::span<const LobeShapes> first_row = {});

}  // namespace lamina

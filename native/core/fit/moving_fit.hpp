// SPDX-License-Identifier: GPL-3.0-or-later
// Fits the shapes of lobes that move with the view: width, anisotropy and tilt of each lobe at each view.
//
// Weights are linear: for given shapes, they are the non-negative fit of each channel with the lobes and some broad
// closures (variable projection, Golub and Pereyra 1973). The shapes minimise what that fit leaves, by the method of
// Levenberg and Marquardt. A penalty on the distance to the shapes at neighbouring views keeps shapes continuous.
#pragma once

#include "fit/lobe_family.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace lamina {

/// The slices of one view.
struct ViewSlices {
  double mu_o = 1.0;
  double phi_o = 0.0;        ///< from the layer's tangent, for oriented lobes
  bool is_mirrored = false;  ///< symmetric about the plane of incidence, as the lobes are then
  Eigen::MatrixXd broad;     ///< [light, closure]: broad closures that the lobes are fitted with
  Eigen::MatrixXd slices;    ///< [light, channel]: f * |cos theta_i|
};

struct MovingFitOptions {
  int lobes = 2;
  double stiffness = 0.02;  ///< of the penalty on the distance to the neighbours' shapes
  int iterations = 8;       ///< at most, of one view
  bool retro = false;       ///< lobes about the viewer are tried too
  /// Most change of an unknown from row to row, so that all views of a row stay near the same minimum.
  double most_change = 0.12;
  double following = 4.0;  ///< the penalty between views of a row that follows another, relative to the first row's
  const LobeFamily* family = &moving_family();
};

/// Shapes of all lobes of one view, one after the other: see LobeFamily::shape.
using LobeShapes = Eigen::VectorXd;
/// Runs body(0), ..., body(count - 1) in any order, perhaps on several threads, and waits for all.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& body)>;

/// Shapes [row][view] for rows of similar stacks, each with views in order from the normal outwards. The fit begins
/// with the last symmetric row, or if there is none with the row that lobes improve most. Its views begin with the
/// shapes of the view before; those of the other rows with the shapes of the neighbouring row. `first_row`: known
/// shapes of the first row, with which the fit begins, or none.
[[nodiscard]] std::vector<std::vector<LobeShapes>> fit_moving_lobes(
    std::span<const std::vector<ViewSlices>> rows, const LightDirections& light, const Eigen::VectorXd& solid_angle,
    const MovingFitOptions& options, const ForEach& for_each, std::span<const LobeShapes> first_row = {});

}  // namespace lamina

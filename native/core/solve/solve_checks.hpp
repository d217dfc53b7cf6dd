// SPDX-License-Identifier: GPL-3.0-or-later
// Error estimates that accompany every solve.
#pragma once
#include <string>

#include "solve/homogeneous_layer.hpp"

namespace lamina {

/// What the always-on checks of a solve found. All are errors, 0 at best.
struct SolveChecks {
  double quadrature = 0.0;   ///< of the moments of the nodes
  double phase = 0.0;        ///< of the discretised phase functions' normalisation
  double energy = 0.0;       ///< created, or lost by conservative layers, at any node
  double reciprocity = 0.0;  ///< asymmetry of the solved kernels, relative
  double negativity = 0.0;   ///< most negative azimuthal mean of a layer's kernel, or value of the stack, relative
  double azimuth = 0.0;      ///< of values of the stack, relative, from azimuth orders left out
  double resolution = 0.0;   ///< estimate of the relative error from the directions' discretisation

  void worsen(const SolveChecks& other);

  /// The checks that fail, with their numbers, or nothing. `tolerance`: relative pointwise error wanted.
  std::string problem(double tolerance) const;
};

/// Checks of one layer from its azimuthal mean (order 0).
SolveChecks check_layer(const HomogeneousModes::Layer& layer, const MultipleScattering& multiple,
                        const PhaseKernel& phase, const TruncatedMedium& medium, const Directions& directions,
                        const DirectionSet& set);

}  // namespace lamina

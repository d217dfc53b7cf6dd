// SPDX-License-Identifier: GPL-3.0-or-later
// Error estimates that accompany every solve.
#pragma once
#include <string>

#include "solve/homogeneous_layer.hpp"

namespace lamina {

/// Results of the checks of every solve. All are errors, ideally 0.
struct SolveChecks {
  double quadrature = 0.0;   ///< error of the nodes' moments
  double phase = 0.0;        ///< error of the normalisation of the discretised phase functions
  double energy = 0.0;       ///< energy gained, or lost by conservative layers, at any node
  double reciprocity = 0.0;  ///< relative asymmetry of the solved kernels
  double negativity = 0.0;   ///< relative size of the most negative azimuthal mean of a layer's kernel, or value of the
                             ///< stack
  double azimuth = 0.0;      ///< relative error of the stack's values from truncated azimuth orders
  double resolution = 0.0;   ///< estimated relative error of the discretisation of directions

  void worsen(const SolveChecks& other);

  /// The failed checks with their numbers, empty if none failed. `tolerance`: the relative pointwise error.
  std::string problem(double tolerance) const;
};

/// Checks of one layer from its azimuthal mean (order 0).
SolveChecks check_layer(const HomogeneousModes::Layer& layer, const MultipleScattering& multiple,
                        const PhaseKernel& phase, const TruncatedMedium& medium, const Directions& directions,
                        const DirectionSet& set);

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison and weighted sums of phase functions, for sublayers of graded media.
#pragma once
#include <utility>
#include <vector>

#include "phase/phase.hpp"

namespace lamina {

/// True if two phase functions are of one kind and have equal values and moments at all test points.
bool alike(const PhaseFunction& a, const PhaseFunction& b);

/// The weighted mean of phase functions. Weights are not negative and not all zero. Equal sorts of particles are
/// joined.
PhaseFunction blend(const std::vector<std::pair<double, const PhaseFunction*>>& weighted);

}  // namespace lamina

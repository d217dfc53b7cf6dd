// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison and weighted sums of phase functions, for sublayers of graded media.
#pragma once
#include <utility>
#include <vector>

#include "phase/phase.hpp"

namespace lamina {

/// Whether two phase functions are the same one: of one kind, with equal values and moments wherever they are compared.
bool alike(const PhaseFunction& a, const PhaseFunction& b);

/// Phase functions in the proportions of their weights, which are not negative and not all zero; sorts of particles
/// that occur more than once are joined.
PhaseFunction blend(const std::vector<std::pair<double, const PhaseFunction*>>& weighted);

}  // namespace lamina

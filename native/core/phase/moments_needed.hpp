// SPDX-License-Identifier: GPL-3.0-or-later
// The number of Legendre moments of a phase function that light needs.
#pragma once
#include <functional>

#include "phase/phase.hpp"

namespace lamina {

/// The least number of moments such that the rest of the series, in which each moment is multiplied by `factor(l)`, is
/// below `tolerance` at all angles: relative to the phase function, or to `faint` where the phase function is smaller.
int moments_needed(const PhaseFunction& phase, double tolerance, double faint,
                   const std::function<double(int)>& factor);

}  // namespace lamina

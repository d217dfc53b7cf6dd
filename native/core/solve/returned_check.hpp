// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the values that a solution returns: convergence in azimuth orders, and sign.
#pragma once
#include "solve/solution.hpp"

namespace lamina {

/// Checks values at a few directions on all sides. Returns the relative contribution of truncated azimuth orders, the
/// relative size of the most negative value, and, below rough boundaries, the relative error of single scattering, from
/// a sum over rays.
SolveChecks check_returned(const Solution& solution, ThreadPool& pool);

}  // namespace lamina

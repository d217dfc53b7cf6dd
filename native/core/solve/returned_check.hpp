// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the values that a solution returns: convergence in azimuth orders, and sign.
#pragma once
#include "solve/solution.hpp"

namespace lamina {

/// Checks values at a few directions on all sides: the possible contribution of truncated azimuth orders, and the most
/// negative value, both relative.
SolveChecks check_returned(const Solution& solution, ThreadPool& pool);

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the values that a solution returns: convergence in azimuth orders, and sign.
#pragma once
#include "solve/solution.hpp"

namespace lamina {

/// Of the values that a solution returns, at a few directions on all sides: what azimuth orders left out may add, and
/// how far below zero values fall, both relative.
SolveChecks check_returned(const Solution& solution, ThreadPool& pool);

}  // namespace lamina

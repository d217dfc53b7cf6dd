// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solution.hpp"

namespace lamina {

/// Of the values that a solution returns, at a few directions on all sides: what azimuth orders left out may add, and
/// how far below zero values fall, both relative.
SolveChecks check_returned(const Solution& solution, ThreadPool& pool);

}  // namespace lamina

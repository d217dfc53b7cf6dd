// SPDX-License-Identifier: GPL-3.0-or-later
// Solves at increasing resolution until the checks pass.
#pragma once
#include "solve/solution.hpp"

namespace lamina {

/// Solves at the resolution that the stack needs, checks the result, and refines while a check fails. With boundaries
/// the returned values are checked too. Throws std::runtime_error, with the numbers, if the finest resolution fails.
Solution solve(const Stack& stack, double tolerance, ThreadPool& pool);

/// Solves with `nodes` nodes per hemisphere, without refinement: a fast preview without guaranteed accuracy.
Solution solve_roughly(const Stack& stack, double tolerance, int nodes, ThreadPool& pool);

/// Solves only the mean over azimuths, for fluxes: facets may be too narrow for a solve of all orders.
Solution solve_mean(const Stack& stack, double tolerance, ThreadPool& pool);

/// Solves at one resolution; failed checks are recorded but do not throw.
Solution solve_at(const Stack& stack, const Resolution& resolution, ThreadPool& pool);

/// Solution::with_thickness, refined while a check fails.
Solution with_thickness(const Solution& solution, std::size_t layer, double tau, ThreadPool& pool);

}  // namespace lamina

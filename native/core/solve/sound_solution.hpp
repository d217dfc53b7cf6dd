// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solve/solution.hpp"

// Solutions whose checks pass: those of the solved layers, and those of the values that a stack with boundaries
// returns.
namespace lamina {

/// Solves at the resolution that the stack needs, checks the result, and refines where a check fails.
/// Throws std::runtime_error, with the numbers, when the finest resolution does not pass either.
Solution solve(const Stack& stack, double tolerance, ThreadPool& pool);

/// The same on that many nodes, however large the errors of discretisation: for a quick look.
Solution solve_roughly(const Stack& stack, double tolerance, int nodes, ThreadPool& pool);

/// The stack at one resolution, with its checks but not judged by them.
Solution solve_at(const Stack& stack, const Resolution& resolution, ThreadPool& pool);

/// Another thickness of one medium, see Solution::with_thickness, refined where a check fails.
Solution with_thickness(const Solution& solution, std::size_t layer, double tau, ThreadPool& pool);

}  // namespace lamina

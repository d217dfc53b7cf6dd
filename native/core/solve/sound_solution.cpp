// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/sound_solution.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "solve/returned_check.hpp"
#include "solve/sublayer_choice.hpp"

namespace lamina {
namespace {

/// Adds the check of returned values for stacks with boundaries, because lobes have azimuth orders of their own.
Solution checked(Solution solution, ThreadPool& pool) {
  if (!has_only_media(solution.stack()) && std::isfinite(solution.resolution().tolerance)) {
    solution.add_checks(check_returned(solution, pool));
  }
  return solution;
}

bool is_sound(const Solution& solution) { return solution.checks().problem(solution.resolution().tolerance).empty(); }

}  // namespace

Solution solve(const Stack& stack, double tolerance, ThreadPool& pool) {
  const Resolution resolution = choose_resolution(stack, tolerance);
  const SublayerStack sublayers = resolved_sublayers(stack, tolerance, pool);
  std::optional<Solution> solution(checked(Solution(sublayers, resolution, pool), pool));
  while (!is_sound(*solution)) {
    const Resolution finer = solution->finer();
    solution.reset();  // before the finer solution is computed: both at once would take twice the memory
    solution.emplace(checked(Solution(sublayers, finer, pool), pool));
  }
  return *std::move(solution);
}

Solution solve_roughly(const Stack& stack, double tolerance, int nodes, ThreadPool& pool) {
  Resolution resolution = choose_resolution(stack, tolerance);
  resolution.nodes = nodes;
  resolution.tolerance = std::numeric_limits<double>::infinity();
  Solution solution(resolved_sublayers(stack, tolerance, pool), resolution, pool);
  solution.require_sound();
  return solution;
}

Solution solve_mean(const Stack& stack, double tolerance, ThreadPool& pool) {
  Solution solution(resolved_sublayers(stack, tolerance, pool), choose_mean_resolution(stack, tolerance), pool);
  solution.require_sound();
  return solution;
}

Solution solve_at(const Stack& stack, const Resolution& resolution, ThreadPool& pool) {
  return checked(Solution(resolved_sublayers(stack, resolution.tolerance, pool), resolution, pool), pool);
}

Solution with_thickness(const Solution& solution, std::size_t layer, double tau, ThreadPool& pool) {
  Solution other = checked(solution.with_thickness(layer, tau, pool), pool);
  while (!is_sound(other)) {
    other = checked(other.at(other.finer(), pool), pool);
  }
  return other;
}

}  // namespace lamina

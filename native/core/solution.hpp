// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <vector>

#include "homogeneous_layer.hpp"
#include "quadrature.hpp"
#include "resolution.hpp"
#include "scattering_function.hpp"
#include "solve_checks.hpp"
#include "stack.hpp"
#include "thread_pool.hpp"

namespace lamina {

/// The solved layers of one channel: for each azimuth order what multiple scattering adds in each layer,
/// from which the stack's scattering function follows for any directions.
class Solution {
 public:
  Solution(Stack stack, const Resolution& resolution, ThreadPool& pool);

  /// The same stack with another thickness of one layer; the modes, which do not depend on it, are shared.
  Solution with_thickness(std::size_t layer, double tau, ThreadPool& pool) const;

  const Stack& stack() const { return stack_; }
  const Quadrature& quadrature() const { return *quadrature_; }
  const Resolution& resolution() const { return resolution_; }
  const SolveChecks& checks() const { return checks_; }
  const std::vector<TruncatedMedium>& media() const { return media_; }
  int orders() const { return static_cast<int>(multiple_.size()); }

  /// The whole stack in one azimuth order.
  ScatteringFunction joined(const Directions& directions, int order) const;

  /// The same without light that was scattered just once, by a medium: smooth in azimuth. Direct light
  /// is left out too.
  ScatteringFunction without_single(const Directions& directions, int order) const;

 private:
  using Modes = std::vector<std::unique_ptr<HomogeneousModes>>;  // by order

  void solve(ThreadPool& pool);
  void solve_layer(int order, std::size_t layer, SolveChecks& checks);
  double share_of_order(int order) const;

  Stack stack_;
  Resolution resolution_;
  std::shared_ptr<const Quadrature> quadrature_;
  std::vector<TruncatedMedium> media_;
  std::vector<std::shared_ptr<Modes>> modes_;              // by layer
  std::vector<std::vector<MultipleScattering>> multiple_;  // by order, layer
  SolveChecks checks_;
};

/// Solves at the resolution that the stack needs, checks the result, and refines where a check fails.
/// Throws std::runtime_error, with the numbers, when the finest resolution does not satisfy it either.
Solution solve(const Stack& stack, double tolerance, ThreadPool& pool);

}  // namespace lamina

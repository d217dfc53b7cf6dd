// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <vector>

#include "directions.hpp"
#include "homogeneous_layer.hpp"
#include "resolution.hpp"
#include "rough_surface.hpp"
#include "sliced_stack.hpp"
#include "solve_checks.hpp"
#include "stack.hpp"
#include "thread_pool.hpp"

namespace lamina {

/// The solved layers of one channel: for each azimuth order what multiple scattering adds in each medium,
/// from which the stack's scattering function follows for any directions.
class Solution {
 public:
  /// Graded layers are sliced to the resolution's tolerance.
  Solution(const Stack& stack, const Resolution& resolution, ThreadPool& pool)
      : Solution(SlicedStack(stack, resolution.tolerance, pool), resolution, pool) {}
  Solution(SlicedStack sliced, const Resolution& resolution, ThreadPool& pool);

  /// The same stack with another thickness of one medium, by its number in the stack as it was given; a graded one
  /// is stretched. The modes, which do not depend on it, are shared and may grow: not for several threads at once.
  Solution with_thickness(std::size_t layer, double tau, ThreadPool& pool) const;

  /// Solves again with finer resolutions until all checks pass. Throws std::runtime_error, with the numbers, where the
  /// finest resolution does not pass either.
  static Solution refined_until_sound(Solution solution, ThreadPool& pool);

  /// The same stack over a Lambert surface of another reflectance, which no layer's own function depends on.
  Solution with_reflectance(double reflectance) const;

  /// As it is solved: graded layers are slices.
  const Stack& stack() const { return sliced_.stack; }
  const Resolution& resolution() const { return resolution_; }
  const SolveChecks& checks() const { return checks_; }
  /// Throws std::runtime_error, with the numbers, when a check misses the tolerance.
  void require_sound() const;
  int orders() const { return static_cast<int>(multiple_.size()); }

  /// A medium among the stack's layers.
  struct Scatterer {
    std::size_t layer;  ///< which of the stack's layers it is
    double ior;         ///< refractive index there
    TruncatedMedium medium;
    PhaseFunction phase;
  };
  const std::vector<Scatterer>& scatterers() const { return scatterers_; }

  /// A rough boundary: number of its layer (that of the base is one past the layers), and its operators.
  struct Boundary {
    std::size_t layer;
    std::shared_ptr<const RoughSurface> surface;
  };
  const std::vector<Boundary>& boundaries() const { return boundaries_; }

  /// The directions of all media between the layers, top first (one more than layers), for targets in air.
  std::vector<Directions> directions(const Eigen::VectorXd& targets) const;

  const MultipleScattering& multiple(int order, std::size_t scatterer) const {
    return multiple_[static_cast<std::size_t>(order)][scatterer];
  }

 private:
  using Modes = std::vector<std::unique_ptr<HomogeneousModes>>;  // by order

  void solve(ThreadPool& pool);
  Resolution finer() const;
  void solve_medium(int order, std::size_t scatterer, SolveChecks& checks);
  void limit_modes();
  double share_of_order(int order) const;
  int fewest_orders() const;
  void add_boundaries(ThreadPool& pool);

  SlicedStack sliced_;
  Resolution resolution_;
  std::shared_ptr<const DirectionSet> set_;
  std::vector<Scatterer> scatterers_;
  std::vector<Directions> native_directions_;              // by scatterer, without targets
  std::vector<std::shared_ptr<Modes>> modes_;              // by scatterer
  std::vector<std::vector<MultipleScattering>> multiple_;  // by order, scatterer
  std::vector<Boundary> boundaries_;
  int boundary_orders_ = 0;
  SolveChecks checks_;
};

/// Solves at the resolution that the stack needs, checks the result, and refines where a check fails.
/// Throws std::runtime_error, with the numbers, when the finest resolution does not satisfy it either.
Solution solve(const Stack& stack, double tolerance, ThreadPool& pool);

/// The same on that many nodes, however large the errors of discretisation: for a quick look.
Solution solve_roughly(const Stack& stack, double tolerance, int nodes, ThreadPool& pool);

}  // namespace lamina

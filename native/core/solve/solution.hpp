// SPDX-License-Identifier: GPL-3.0-or-later
// The solved layers of a stack, one channel.
#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "matter/stack.hpp"
#include "numeric/thread_pool.hpp"
#include "operators/directions.hpp"
#include "rough/rough_surface.hpp"
#include "solve/angle_table.hpp"
#include "solve/homogeneous_layer.hpp"
#include "solve/resolution.hpp"
#include "solve/solve_checks.hpp"
#include "solve/sublayer_stack.hpp"

namespace lamina {

/// The solved layers of one channel: the multiple scattering of each medium in each azimuth order. The scattering
/// function of the stack for any directions is computed from these.
class Solution {
 public:
  Solution(SublayerStack sublayers, const Resolution& resolution, ThreadPool& pool);

  /// The stack with another thickness of one medium, given by its index in the original stack; a graded medium is
  /// stretched. The modes, which do not depend on thickness, are shared and may grow. Thread-safe.
  Solution with_thickness(std::size_t layer, double tau, ThreadPool& pool) const;

  /// The stack at another resolution.
  Solution at(const Resolution& resolution, ThreadPool& pool) const { return {sublayers_, resolution, pool}; }

  /// The resolution to try after a failed check: more azimuth orders if orders are missing, otherwise more nodes.
  /// Throws std::runtime_error if no finer resolution exists.
  Resolution finer() const;

  /// The stack over a Lambert surface of another reflectance. The solved layers do not depend on it.
  Solution with_reflectance(double reflectance) const;

  /// The stack as it is solved, with sublayers for graded layers.
  const Stack& stack() const { return sublayers_.stack; }
  const Resolution& resolution() const { return resolution_; }
  const DirectionSet& direction_set() const { return *set_; }
  const SolveChecks& checks() const { return checks_; }
  void add_checks(const SolveChecks& more) { checks_.worsen(more); }
  /// Throws std::runtime_error, with the numbers, if a check exceeds the tolerance.
  void require_sound() const;
  int orders() const { return static_cast<int>(multiple_.size()); }

  /// A scattering medium of the stack.
  struct Scatterer {
    std::size_t layer;  ///< index of its layer
    double ior;         ///< refractive index
    TruncatedMedium medium;
    PhaseFunction phase;
    std::shared_ptr<const MattePhase> matte = {};  ///< of matte flakes

    /// The untruncated phase function between a ray and others, see flake_phase; `azimuths`: cosines of dphi.
    Eigen::ArrayXd phase_of(double mu_o, const Eigen::ArrayXd& mu_i, double turn, const Eigen::ArrayXd& azimuths) const;
    Eigen::ArrayXd phase_of(double mu_o, double mu_i, double turn, const Eigen::ArrayXd& azimuths) const {
      return phase_of(mu_o, Eigen::ArrayXd::Constant(azimuths.size(), mu_i), turn, azimuths);
    }
  };
  const std::vector<Scatterer>& scatterers() const { return scatterers_; }

  /// A rough boundary: the index of its layer (the base is one past the layers), and its operators.
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

  /// What evaluation keeps between calls.
  KeptTables& kept_tables() const { return *kept_tables_; }

 private:
  using Modes = std::vector<std::unique_ptr<HomogeneousModes>>;  // by order

  void solve(ThreadPool& pool);
  void solve_medium(int order, std::size_t scatterer, SolveChecks& checks);
  void limit_modes();
  double share_of_order(int order) const;
  bool has_flakes() const;
  bool is_rough() const;
  int fewest_orders() const;
  std::size_t ranges_for(double tau) const;
  double orders_needed() const;
  void add_boundaries(ThreadPool& pool);

  SublayerStack sublayers_;
  Resolution resolution_;
  std::shared_ptr<const DirectionSet> set_;
  std::vector<Scatterer> scatterers_;
  std::vector<Directions> native_directions_;               // by scatterer, without targets
  std::vector<std::shared_ptr<const FlakeKernel>> flakes_;  // by scatterer; null for other media
  std::vector<std::shared_ptr<Modes>> modes_;               // by scatterer
  std::shared_ptr<std::mutex> modes_lock_ = std::make_shared<std::mutex>();
  std::vector<std::vector<MultipleScattering>> multiple_;  // by order, scatterer
  std::vector<Boundary> boundaries_;
  int boundary_orders_ = 0;
  SolveChecks checks_;
  std::shared_ptr<KeptTables> kept_tables_ = std::make_shared<KeptTables>();
};

}  // namespace lamina

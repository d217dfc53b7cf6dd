// SPDX-License-Identifier: GPL-3.0-or-later
// Single scattering by media of light that crosses rough boundaries on its way in or out.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solve/assembly.hpp"
#include "solve/evaluation.hpp"
#include "solve/mirror_sections.hpp"

namespace lamina {

/// Light that a medium scatters once, and that at most one lobe of a rough boundary spreads on its way in, and at most
/// one on its way out. The moments of a phase function that the nodes do not resolve are missing in the assembly, and
/// narrow lobes hardly blur them: a bow or a glory of a tabulated phase function would come out too faint. For such
/// phase functions this light is computed a second time, with all moments, on nodes that resolve them, and the
/// difference is added to the azimuth orders.
class ScatteringBetweenLobes {
 public:
  /// Keeps references into the assembly. With `keeps_held`, without_single() keeps what held() returns.
  ScatteringBetweenLobes(const Assembly& assembly, ThreadPool& pool, bool keeps_held = false);
  ~ScatteringBetweenLobes();

  /// The number of azimuth orders of all light: more than those of the solution if a phase function needs more.
  int orders() const;

  /// Assembly::without_single with the difference; nothing else in the orders beyond those of the solution.
  ScatteringFunction without_single(int order) const;

  bool none() const { return coarse_ == nullptr; }

  /// What each azimuth order holds of this light, for light from above that leaves above: pi f between all targets.
  std::vector<Eigen::MatrixXd> held() const;

 private:
  struct Level;

  const Assembly& assembly_;
  MirrorSections sections_;
  std::unique_ptr<Level> coarse_;
  std::unique_ptr<Level> fine_;                // null if the nodes of the solution resolve all phase functions
  mutable std::vector<Eigen::MatrixXd> held_;  // by order; empty: not kept
};

}  // namespace lamina

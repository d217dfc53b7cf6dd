// SPDX-License-Identifier: GPL-3.0-or-later
// Light that media scatter once between the lobes of rough boundaries, as a sum over rays.
#pragma once
#include <Eigen/Core>

#include "solve/assembly.hpp"
#include "solve/mirror_sections.hpp"

namespace lamina {

/// The light that media scatter once, and that rough boundaries spread before, or after, or both, from above to above.
/// A check of ScatteringBetweenLobes, with the phase function itself: without nodes, moments and azimuth orders.
class RaysBetweenLobes {
 public:
  /// Keeps a reference to the assembly.
  explicit RaysBetweenLobes(const Assembly& assembly) : assembly_(assembly), sections_(assembly.solution()) {}

  /// In 1/sr between two targets. `precise`: with so many rays that they meet each peak of the phase function; few rays
  /// are enough for smooth phase functions and narrow lobes.
  Eigen::ArrayXd value(Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& dphi, bool precise) const;

 private:
  struct RaySet;
  struct Bundle;
  Bundle bundle(std::size_t scatterer, Eigen::Index target, bool leaving, int degree) const;
  Eigen::ArrayXd pairs(std::size_t scatterer, const RaySet& out, const RaySet& in, const Eigen::ArrayXd& dphi) const;
  int degree_of(const Solution::Scatterer& scatterer) const;

  const Assembly& assembly_;
  MirrorSections sections_;
};

}  // namespace lamina

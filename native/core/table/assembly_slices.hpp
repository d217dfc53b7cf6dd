// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of any stack, from an assembly.
#pragma once
#include <map>
#include <span>
#include <utility>

#include "solve/assembly.hpp"
#include "solve/scattering_between_lobes.hpp"
#include "solve/stack_single_scattering.hpp"
#include "table/slice_source.hpp"

namespace lamina {

/// Slices of any stack: views and lights are the targets of one assembly.
class AssemblySlices : public SliceSource {
 public:
  AssemblySlices(const Solution& solution, std::span<const Sight> sights, const SliceGrid& grid, ThreadPool& pool);

  int orders() const override { return between_.orders(); }
  std::vector<Eigen::MatrixXd> order(int m) override;
  void add_once(const Sight& sight, Eigen::Index view, Slice slice) const override;
  void add_lobes(const Sight& sight, Eigen::Index view, Slice slice) const override;
  Shares shares(const Sight& sight) const override;

 private:
  std::span<const Sight> sights_;
  Eigen::Index views_;
  Eigen::ArrayXd azimuth_;  // cosines of dphi
  Assembly assembly_;
  ScatteringBetweenLobes between_;
  std::map<std::pair<Side, Path>, StackSingleScattering> once_;
};

}  // namespace lamina

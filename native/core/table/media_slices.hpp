// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of stacks of media: the fast path.
#pragma once
#include <memory>
#include <span>

#include "table/slice_source.hpp"
#include "table/view_light_kernels.hpp"

namespace lamina {

/// The fast path to slices, for media over nothing or a Lambert surface: kernels are joined only between views and
/// lights.
class MediaSlices : public SliceSource {
 public:
  MediaSlices(const Solution& solution, std::span<const Sight> sights, const SliceGrid& grid)
      : solution_(solution), sights_(sights), grid_(grid), geometry_(solution, grid.view_mu, grid.light_mu) {}

  int orders() const override { return solution_.orders(); }
  std::vector<Eigen::MatrixXd> order(int m) override;
  void add_once(const Sight& sight, Eigen::Index view, Slice slice) const override;
  void add_lobes(const Sight&, Eigen::Index, Slice) const override {}
  Shares shares(const Sight& sight) const override;

 private:
  void add_medium(const Sight& sight, Eigen::Index view, std::size_t layer, Slice& slice) const;

  const Solution& solution_;
  std::span<const Sight> sights_;
  const SliceGrid& grid_;
  ViewLightGeometry geometry_;
  std::unique_ptr<ScatteringFunction> zeroth_;
};

}  // namespace lamina

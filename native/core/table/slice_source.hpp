// SPDX-License-Identifier: GPL-3.0-or-later
// The interface of the two ways to evaluate slices, with views (sights) and the grid of lights.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "solve/evaluation.hpp"

namespace lamina {

/// A viewer above (top) or below (bottom) a stack who sees light that entered on the viewer's side (reflect) or on the
/// other side (transmit).
struct Sight {
  Side viewer = Side::kTop;
  Path path = Path::kReflect;

  /// The side where light enters: the viewer's side for reflection, the other side for transmission.
  Side entry() const { return (viewer == Side::kTop) == (path == Path::kReflect) ? Side::kTop : Side::kBottom; }
};

/// The product grid of a lookup table.
struct SliceGrid {
  Eigen::VectorXd view_mu;
  Eigen::VectorXd light_mu;
  Eigen::VectorXd dphi;

  Eigen::Index lights() const { return light_mu.size() * dphi.size(); }
};

/// Evaluates one solution between the views and lights of a grid, for all sights.
class SliceSource {
 public:
  /// f in 1/sr of one view, [light cosine, dphi].
  using Slice = Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  SliceSource() = default;
  SliceSource(const SliceSource&) = delete;
  SliceSource& operator=(const SliceSource&) = delete;
  virtual ~SliceSource() = default;

  virtual int orders() const = 0;
  /// An azimuth order of pi f by sight, [view, light], without single scattering and without deltas. Called once per
  /// order, from several threads.
  virtual std::vector<Eigen::MatrixXd> order(int m) = 0;
  /// Adds single scattering by media to the slice of a view.
  virtual void add_once(const Sight& sight, Eigen::Index view, Slice slice) const = 0;
  /// Adds the lobes of rough boundaries (single scattering by facets) to the slice of a view.
  virtual void add_lobes(const Sight& sight, Eigen::Index view, Slice slice) const = 0;
  /// By view: the share of scattered light, and of specular reflection or unscattered transmission. Valid after order
  /// 0.
  struct Shares {
    Eigen::VectorXd albedo;
    Eigen::VectorXd direct;
  };
  virtual Shares shares(const Sight& sight) const = 0;
};

}  // namespace lamina

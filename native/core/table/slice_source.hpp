// SPDX-License-Identifier: GPL-3.0-or-later
// What evaluates slices: views (sights), the grid of lights, and the interface of both roads.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "solve/evaluation.hpp"

namespace lamina {

/// What a viewer above (top) or below (bottom) a stack sees: light that came in on the viewer's side
/// (reflect) or on the other one (transmit).
struct Sight {
  Side viewer = Side::kTop;
  Path path = Path::kReflect;

  /// By reciprocity the side where light enters is the viewer's for reflection, the other for transmission.
  Side entry() const { return (viewer == Side::kTop) == (path == Path::kReflect) ? Side::kTop : Side::kBottom; }
};

/// The product grid of a lookup table.
struct SliceGrid {
  Eigen::VectorXd view_mu;
  Eigen::VectorXd light_mu;
  Eigen::VectorXd dphi;

  Eigen::Index lights() const { return light_mu.size() * dphi.size(); }
};

/// One solution between the views and lights of a grid, for all sights.
class SliceSource {
 public:
  /// f in 1/sr of one view, [light cosine, dphi].
  using Slice = Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  SliceSource() = default;
  SliceSource(const SliceSource&) = delete;
  SliceSource& operator=(const SliceSource&) = delete;
  virtual ~SliceSource() = default;

  /// An azimuth order of pi f by sight, [view, light], without light scattered once and without deltas. Each
  /// order is asked for once, several at a time.
  virtual std::vector<Eigen::MatrixXd> order(int m) = 0;
  /// Light that a medium scatters once, added to the slice of a view.
  virtual void add_once(const Sight& sight, Eigen::Index view, Slice slice) const = 0;
  /// Lobes of rough boundaries, light that their facets scatter once, likewise.
  virtual void add_lobes(const Sight& sight, Eigen::Index view, Slice slice) const = 0;
  /// By view: the share that reaches the other directions, and that of mirrors (reflect) or straight through
  /// (transmit). After order 0.
  struct Shares {
    Eigen::VectorXd albedo;
    Eigen::VectorXd direct;
  };
  virtual Shares shares(const Sight& sight) const = 0;
};

}  // namespace lamina

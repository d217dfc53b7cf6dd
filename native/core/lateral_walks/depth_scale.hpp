// SPDX-License-Identifier: GPL-3.0-or-later
// Optical depth in a medium as depth in millimetres.
#pragma once
#include <cstddef>
#include <vector>

namespace lamina {

/// How optical depth in a medium becomes millimetres. Between knots sigma_t is linear in the depth in mm, so that its
/// square is linear in the optical depth.
class DepthScale {
 public:
  struct Knot {
    double tau = 0.0;      ///< optical depth below the medium's top
    double depth = 0.0;    ///< the same in mm
    double sigma_t = 0.0;  ///< in 1/mm
  };
  /// One depth of the medium.
  struct Place {
    double depth = 0.0;
    double sigma_t = 0.0;
    std::size_t piece = 0;
  };

  /// No medium: no length.
  DepthScale() : DepthScale({{}, {}}) {}
  /// Two knots or more, top first; the last may lie at infinity. Throws std::invalid_argument for knots that do not
  /// descend.
  explicit DepthScale(std::vector<Knot> knots);
  /// Several media, top first, as one.
  static DepthScale joined(const std::vector<DepthScale>& scales);

  Place top() const { return {0.0, knots_.front().sigma_t, 0}; }
  Place bottom() const { return {thickness(), knots_.back().sigma_t, knots_.size() - 2}; }
  /// The top's and the bottom's own places at the optical depths of these, an empty part beside them included.
  Place at(double tau) const;
  double thickness() const { return knots_.back().depth; }
  /// Length in mm of a straight flight between two places, of that optical length, at the cosine `mu` with the normal.
  double length(const Place& from, const Place& to, double optical, double mu) const;
  const std::vector<Knot>& knots() const { return knots_; }

 private:
  std::vector<Knot> knots_;
  bool uniform_ = false;  ///< one sigma_t, above 0
};

}  // namespace lamina

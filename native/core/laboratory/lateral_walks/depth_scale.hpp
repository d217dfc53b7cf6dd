// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of optical depth in a medium to depth in millimetres.
#pragma once
#include <cstddef>
#include <vector>

namespace lamina {

/// Converts optical depth in a medium to depth in millimetres. Between knots sigma_t is linear in the depth in mm, so
/// sigma_t^2 is linear in the optical depth.
class DepthScale {
 public:
  struct Knot {
    double tau = 0.0;      ///< optical depth below the medium's top
    double depth = 0.0;    ///< depth below the medium's top in mm
    double sigma_t = 0.0;  ///< in 1/mm
  };
  /// One point of the depth scale.
  struct Place {
    double depth = 0.0;
    double sigma_t = 0.0;
    std::size_t piece = 0;
  };

  /// A medium without thickness.
  DepthScale() : DepthScale({{}, {}}) {}
  /// `knots`: two or more, top first; the last may be at infinity. Throws std::invalid_argument if tau or depth
  /// decreases.
  explicit DepthScale(std::vector<Knot> knots);
  /// Joins several media, top first, into one scale.
  static DepthScale joined(const std::vector<DepthScale>& scales);

  Place top() const { return {0.0, knots_.front().sigma_t, 0}; }
  Place bottom() const { return {thickness(), knots_.back().sigma_t, knots_.size() - 2}; }
  /// At the optical depths of the top and the bottom this is top() or bottom(), with any clear part next to it.
  Place at(double tau) const;
  double thickness() const { return knots_.back().depth; }
  /// Length in mm of a straight flight of optical length `optical` between two places, at the cosine `mu` with the
  /// normal.
  double length(const Place& from, const Place& to, double optical, double mu) const;
  const std::vector<Knot>& knots() const { return knots_; }

 private:
  std::vector<Knot> knots_;
  bool uniform_ = false;  ///< true if sigma_t is constant and positive
};

}  // namespace lamina

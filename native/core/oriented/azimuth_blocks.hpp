// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of the azimuth, in blocks that light with twofold symmetry does not leave.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace lamina {

/// The functions 1, sqrt(2) cos(m phi) and sqrt(2) sin(m phi) of orders m below `orders`, orthonormal in the mean over
/// the circle. Function m is the cosine of order m, function orders - 1 + m the sine.
///
/// Facets look the same after half a turn, so they never turn even orders into odd ones. If all tangents lie along or
/// across the x axis, facets do not turn cosines into sines either.
struct AzimuthBlocks {
  int orders = 1;
  bool mirrored = true;
  /// Even cosines, odd cosines, even sines, odd sines; without mirror symmetry even and odd functions.
  std::vector<std::vector<Eigen::Index>> functions;

  AzimuthBlocks(int orders, bool mirrored);

  Eigen::Index count() const { return 2 * orders - 1; }
  int order_of(Eigen::Index function) const {
    return static_cast<int>(function < orders ? function : function - orders + 1);
  }
  bool is_sine(Eigen::Index function) const { return function >= orders; }
  /// All functions at the azimuth with this cosine and sine.
  Eigen::VectorXd at(double cosine, double sine) const;
  Eigen::VectorXd at(double phi) const;
  /// Coefficients of functions, [any, function], of a pattern that is turned by `angle`.
  Eigen::MatrixXd turned(const Eigen::MatrixXd& coefficients, double angle) const;
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Azimuth nodes for the radiance at one lateral frequency, on a path in the complex plane.
#pragma once
#include <Eigen/Core>

namespace lamina {

/// Azimuth nodes for the radiance at one lateral frequency, measured from the direction of the wave.
///
/// A wave exp(i q x) adds i q sin(theta) cos(phi) to the extinction. Averages over phi then have poles close to the
/// real axis, where light runs along the crests, and many real azimuths are needed to resolve the poles. The equation
/// of transfer is analytic in phi, so the path of integration may leave the real axis: phi = x + i bend sin(x), with x
/// at midpoints of (0, pi). The extinction along this path is 1 + q sin(theta) sin(x) sinh(y) + i ..., with a real part
/// that grows with q, and a few azimuths are enough at all frequencies. Without a bend the azimuths are equivalent to
/// the orders cos(m phi), m < count, and the wave couples neighbouring orders.
///
/// The radiances at phi and pi - conj(phi) are complex conjugates. A pair of azimuths is therefore stored as two real
/// numbers, the real part (row j) and the imaginary part (row count / 2 + j). Odd azimuth orders are stored divided by
/// i, which makes all operators real.
struct AzimuthRule {
  Eigen::Index count = 1;
  Eigen::MatrixXd wave;         ///< i cos(phi), as a real matrix: blocks of 2 x 2
  Eigen::MatrixXd to_orders;    ///< from azimuths to orders sqrt(2 - delta_m0) cos(m phi): [order, azimuth]
  Eigen::MatrixXd from_orders;  ///< [azimuth, order]
  Eigen::ArrayXcd cosines;      ///< cos(phi) of the first azimuth of each pair; empty for a count of 1
  Eigen::ArrayXcd weights;      ///< weights of the pairs: a mean is the sum of real parts
  /// Number of orders that the azimuths keep apart: the errors of the products of two of them are below 1e-2, and those
  /// with order 0 below 1e-6. Higher orders of a lobe, which do not fall as those of a phase function, would change the
  /// energy of order 0.
  Eigen::Index orders_apart = 1;

  Eigen::Index orders() const { return to_orders.rows(); }

  /// `count` is even, or 1 for radiance without azimuth dependence; `orders` is at most `count`. If the moments of a
  /// phase function fall as peak^l, its kernel is analytic for bends up to -ln(peak) / 2.
  AzimuthRule(Eigen::Index count, double bend, Eigen::Index orders);
  /// For radiance with azimuth order 0 only: at frequency 0, or along the normal.
  static AzimuthRule mean() { return {1, 0.0, 1}; }
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Azimuths at which light of a lateral frequency is held, on a path in the complex plane.
#pragma once
#include <Eigen/Core>

namespace lamina {

/// Azimuths at which light of one lateral frequency is held, measured from the direction of the wave.
///
/// A wave exp(i q x) adds i q sin(theta) cos(phi) to the extinction. Averages over phi then have poles close to the
/// real axis, where light runs along the crests, and real azimuths resolve those only by their number. The equation of
/// transfer is analytic in phi, so the path of integration may leave the real axis: phi = x + i bend sin(x), with x at
/// midpoints of (0, pi). The extinction along this path is 1 + q sin(theta) sin(x) sinh(y) + i ..., whose real part
/// grows with q, and a few azimuths serve all frequencies. Without a bend these are the orders cos(m phi), m < count,
/// of which the wave couples each with its neighbours.
///
/// The azimuths phi and pi - conj(phi) hold conjugate radiance. A pair is therefore two real numbers, the real part
/// (row j) and the imaginary part (row count / 2 + j). Of azimuth orders, odd ones are stored divided by i, which makes
/// all operators real.
struct AzimuthRule {
  Eigen::Index count = 1;
  Eigen::MatrixXd wave;         ///< i cos(phi), as a real matrix: blocks of 2 x 2
  Eigen::MatrixXd to_orders;    ///< from azimuths to orders sqrt(2 - delta_m0) cos(m phi): [order, azimuth]
  Eigen::MatrixXd from_orders;  ///< [azimuth, order]
  Eigen::ArrayXcd cosines;      ///< of the first azimuth of each pair; empty for a count of 1
  Eigen::ArrayXcd weights;      ///< of these, the two of a pair together: a mean is the sum of real parts

  Eigen::Index orders() const { return to_orders.rows(); }

  /// An even count, or 1 where the azimuth does not matter; `orders` at most count. Functions of a phase function
  /// whose moments fall as peak^l are analytic as far as bends of -ln(peak) / 2.
  AzimuthRule(Eigen::Index count, double bend, Eigen::Index orders);
  /// Light that has one azimuth order, the mean: of no frequency, or along the normal.
  static AzimuthRule mean() { return {1, 0.0, 1}; }
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Projects rays onto azimuth orders and polynomials in the cosine by a nonuniform Fourier transform.
#pragma once
#include <Eigen/Core>

#include "numeric/quadrature.hpp"

namespace lamina {

/// The tables of WaveGrid for one range of nodes and a number of azimuth orders.
struct WaveTables {
  double low;
  double length;             // of the range of cosines
  Eigen::MatrixXd to_nodes;  // [node, line of the grid in the cosine]
  // [line in the first half of the grid in the azimuth, order]: waves of even order are even about the middle of the
  // grid, those of odd order are odd.
  Eigen::MatrixXd to_even_orders;
  Eigen::MatrixXd to_odd_orders;

  WaveTables(const Quadrature& nodes, int orders);
};

/// Sums over rays of share * (Lagrange polynomial of a node at the ray's cosine) * cos(m azimuth), for all nodes of a
/// range and all azimuth orders.
///
/// The polynomials are sums of cos(j t) with cosine = low + length (1 + cos t) / 2, so both factors are waves. Rays are
/// spread onto a grid twice as fine as the shortest waves, and the waves are summed over the grid: the nonuniform
/// Fourier transform of type 1, with the kernel of Barnett, Magland and af Klinteberg (2019). The error is about 1e-7
/// of the sum of shares. The cost of a ray does not depend on the number of nodes and orders.
class WaveGrid {
 public:
  explicit WaveGrid(const WaveTables& tables);

  void clear() { grid_.setZero(); }
  /// Adds a ray with a cosine in the range and the cosine of its azimuth.
  void add(double share, double mu, double azimuth);
  /// The sums, [node, order].
  Eigen::MatrixXd sums() const;

 private:
  const WaveTables& tables_;
  Eigen::MatrixXd grid_;  // [cosine, azimuth], with lines beyond all ends
};

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Quadrature that is fine towards the ends of an interval.
#pragma once
#include <vector>

namespace lamina {

/// Places and weights of an integral.
struct Nodes {
  std::vector<double> place;
  std::vector<double> weight;
};

/// Gauss's rule on pieces of (low, high) that double in length away from `low`, where the first is as long as `finest`;
/// towards `high` as well where the integrand has a root there.
Nodes graded(double low, double high, double finest, bool root_at_high);

/// For functions of a cosine between `critical` and 1: pieces shrink towards both ends.
Nodes between_cosines(double critical);

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// Quadrature that is fine towards the ends of an interval.
#pragma once
#include <vector>

namespace lamina {

/// Nodes and weights of a quadrature.
struct Nodes {
  std::vector<double> place;
  std::vector<double> weight;
};

/// Gauss-Legendre rules on pieces of (low, high). The first piece has the length `finest`, and pieces double in length
/// away from `low`. With `root_at_high` they also shrink towards `high`, for integrands with a square root there.
Nodes graded(double low, double high, double finest, bool root_at_high);

/// Quadrature over cosines between `critical` and 1, with pieces that shrink towards both ends.
Nodes between_cosines(double critical);

}  // namespace lamina

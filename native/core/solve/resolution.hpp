// SPDX-License-Identifier: GPL-3.0-or-later
// How finely a solve discretises directions, chosen from the stack.
#pragma once
#include "matter/stack.hpp"

namespace lamina {

/// How finely a solve discretises directions, and by what it is judged afterwards.
struct Resolution {
  int nodes = 32;                   ///< quadrature nodes in a hemisphere
  int fewest_orders = 0;            ///< of azimuth, beside those that convergence asks for
  double thinnest = 1.0;            ///< least optical thickness that the nodes must resolve
  double azimuth_tolerance = 3e-5;  ///< orders are added until what they add falls below this share
  double tolerance = 1e-3;          ///< largest admitted estimate of the relative pointwise error

  int moments() const { return 2 * nodes; }
};

/// Layers thinner than this are held to scatter once: the rest is a share of their thickness times its
/// logarithm.
inline constexpr double kThinnestRepeated = 1e-9;

/// Nodes are divided down to cosines like this thickness and no further. In a layer thinner still, light that streams
/// sideways scatters again with a share of about the thickness times its logarithm, and the nodes miss a part of that.
inline constexpr double kThinnestResolved = 1e-5;

/// Directions enough for the stack's phase functions: Gauss nodes on a half-range integrate the products
/// of the first 2n moments, and |chi_2n| is what the truncation of the forward peak must make good.
/// Throws std::runtime_error where no admitted number of nodes is enough.
/// `tolerance` is the relative pointwise error wanted for cosines >= .05.
Resolution choose_resolution(const Stack& stack, double tolerance);

/// Azimuth orders for what three lobes in a row scatter, to that relative error; 0 where light cannot get from lobe to
/// lobe. Two in a row are integrated otherwise between given directions, see FacetMeetings.
int orders_for_lobes(const Stack& stack, double tolerance);

/// The largest number of azimuth orders that a solve tries.
inline constexpr int kMostOrders = 200;

/// Nodes that resolve in the cosine what so many orders resolve in the azimuth.
inline int nodes_beside(int orders) { return 8 * ((3 * orders + 79) / 80); }

/// The next finer one, or the same when there is none.
Resolution refined(const Resolution& resolution);

}  // namespace lamina

// SPDX-License-Identifier: GPL-3.0-or-later
// The resolution of a solve: numbers of nodes and azimuth orders, chosen from the stack.
#pragma once
#include <algorithm>

#include "matter/stack.hpp"

namespace lamina {

/// The discretisation of directions, and the tolerances of the checks.
struct Resolution {
  int nodes = 32;                   ///< quadrature nodes in a hemisphere
  int fewest_orders = 0;            ///< least number of azimuth orders
  double thinnest = 1.0;            ///< least optical thickness that the nodes must resolve
  double azimuth_tolerance = 3e-5;  ///< orders are added until their relative contribution is below this
  double tolerance = 1e-3;          ///< largest admitted estimate of the relative pointwise error
  bool only_mean = false;           ///< true if only the mean over azimuths is solved: fluxes, and no directions

  int moments() const { return 2 * nodes; }
};

/// Thinner layers scatter light only once.
inline constexpr double kThinnestRepeated = 1e-9;

/// Layers up to this optical thickness need no nodes of their own: their multiple scattering may be coarse, because its
/// share in the light that the layer scatters, about thickness * |log(thickness)|, is at most a tenth of the tolerance.
/// Single scattering is always exact.
inline double thickest_unresolved(double tolerance) { return 1e-2 * std::min(tolerance, 1e-2); }

/// The node ranges are divided down to cosines about equal to the thickness, but not below this value. In thinner
/// layers part of the multiple scattering of grazing light is missed; its share is about thickness * |log(thickness)|.
inline constexpr double kLeastDivision = 1e-5;

/// The resolution for the stack's phase functions. n Gauss nodes per hemisphere integrate products of the first 2n
/// moments, and |chi_2n| is left to the truncation of the forward peak. `tolerance` is the relative pointwise error for
/// cosines >= .05. Throws std::runtime_error if the largest number of nodes is not enough.
Resolution choose_resolution(const Stack& stack, double tolerance);

/// The resolution for the mean over azimuths alone: facets may have any width.
Resolution choose_mean_resolution(const Stack& stack, double tolerance);

/// Number of azimuth orders for three successive lobes at the relative error `tolerance`; 0 if light cannot pass from
/// lobe to lobe. Two successive lobes are integrated separately, see FacetMeetings.
int orders_for_lobes(const Stack& stack, double tolerance);

/// The largest number of azimuth orders that a solve tries.
inline constexpr int kMostOrders = 200;

/// The slowest decay from one azimuth order to the next that the check of returned values assumes.
inline constexpr double kSlowestDecay = 0.974;

/// Number of nodes whose resolution in the cosine matches the resolution of `orders` in the azimuth.
inline int nodes_beside(int orders) { return 8 * ((3 * orders + 79) / 80); }

/// The next finer resolution, or the same if there is none.
Resolution refined(const Resolution& resolution);

}  // namespace lamina

# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean direction of light that leaves a deep medium: on average the light leans away from its entry.

After n scatterings, the tangent of the angle between the mean direction and the normal is .73 / sqrt(n - .56) for
isotropic scattering: the distance from the entry grows with sqrt(n), and the last flight is a part of it. Photons give
the same within 9 % from n = 1 to 150. Henyey and Greenstein's phase function is taken for n (1 - g^2) isotropic
scatterings: photons with g = .8 lean 20 % more at n = 15 to 20, and 5 % more at 50."""

from __future__ import annotations

import numpy as np

from .first_orders import FirstOrders

FACTOR, LESS = 0.73, 0.56
MOST = 400  # orders
# Part of the angle that a tilted Diffuse closure gets. The whole would give too much light near the horizon. From a
# half to the whole, a sphere's error under a sun changes by less than a tenth of the error without tilt.
PART = 0.6


def tangent(order: np.ndarray, g: float) -> np.ndarray:
    """The tangent of the angle after `order` scatterings."""
    return FACTOR / np.sqrt(np.maximum(order * (1.0 - g * g), 1.0) - LESS)


def of_orders(first: FirstOrders) -> float:
    """The tangent by which a closure leans for the light after the orders `first`, the mean over channels weighted by
    their light."""
    order = np.arange(first.count + 1, first.count + MOST)
    albedo = first.medium.sigma_s / first.medium.extinction
    light = albedo[:, None] ** order * (order + 1.5) ** -1.5  # like the returns of a random walk
    return PART * float(np.sum(light * tangent(order, first.medium.g)) / max(np.sum(light), 1e-300))

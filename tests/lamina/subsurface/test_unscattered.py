# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that crosses a body without scattering."""

import numpy as np
import pytest

import lamina
from lamina import HalfSpace, Interface, Knot, Lambert, Medium, Stack
from lamina.subsurface import unscattered


@pytest.mark.parametrize("paths", [1e-4, 0.04, 1.0, 5.0])
def test_share_of_unscattered_light(paths):
    cosines = (np.arange(100_000) + 0.5) / 100_000
    wanted = np.mean(2.0 * cosines * np.exp(-paths * cosines))
    assert unscattered.unscattered_share(paths) == pytest.approx(wanted, rel=1e-6)


def test_mean_width_of_a_box():
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)], float) + 7.0
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([part for a, b, c, d in quads for part in ((a, b, c), (a, c, d))])
    assert unscattered.mean_width(corners, triangles) == pytest.approx(6.0 * 6.0 / 22.0)


def test_largest_extinction_of_layers_base_and_knots():
    medium = Medium(sigma_s=[1.0, 2.0, 3.0], sigma_a=0.5, thickness=1.0)
    deep = HalfSpace(sigma_s=4.0, sigma_a=[0.0, 0.25, 0.5])
    graded = Medium(thickness=1.0, profile=[Knot(0.0, sigma_s=1.0, sigma_a=0.01), Knot(1.0, sigma_s=5.0, sigma_a=0.1)])
    for stack, largest in ((Stack([Interface(1.5), medium]), 3.5), (Stack([medium], deep), 4.5),
                           (Stack([graded]), 5.1), (Stack([Interface(1.5)], Lambert(0.5)), 0.0)):
        assert unscattered.largest_extinction(stack) == pytest.approx(largest)
    with pytest.raises(lamina.StackError, match="has no lengths"):
        unscattered.largest_extinction(Stack([Medium(albedo=0.5, tau=1.0)]))

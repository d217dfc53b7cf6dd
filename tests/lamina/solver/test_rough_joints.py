# SPDX-License-Identifier: GPL-3.0-or-later
"""Two coats of which the joint is rough, on rough metals: light is refracted by narrow lobes before and after it is
reflected by a wide lobe."""

import numpy as np
import pytest
from solver_and_walks import compared, z_scores
from z_limit import z_limit

import lamina
from lamina import Conductor, Interface, Stack

POINTS = [(0.3, 0.6, 0.0), (0.6, 0.6, 3.0), (0.9, 0.7, 1.5)]
COSINES = np.array([0.1, 0.6, 0.95])


def coats(ior, joint, metal):
    return Stack([Interface(1.5), Interface(ior, alpha=joint)], Conductor(alpha=metal, facing=0.95, grazing=0.99))


@pytest.mark.parametrize("ior", [1.3, 1.4, 1.45, 1.49, 1.52, 1.6])
@pytest.mark.parametrize("joint", [0.1, 0.3, 0.5])
@pytest.mark.parametrize("metal", [0.05, 0.1, 0.3, 0.6])
def test_all_such_coats_are_solved(ior, joint, metal):
    found = lamina.solve(coats(ior, joint, metal), "preview")
    assert np.all(found.reflectance(COSINES) < 1.0)
    assert found.brdf(0.9, 0.7, 1.5) == pytest.approx(found.brdf(0.7, 0.9, 1.5), rel=1e-2)


@pytest.mark.parametrize("ior, joint, metal", [
    (1.49, 0.3, 0.3), (1.6, 0.3, 0.2), (1.45, 0.5, 0.05), (1.52, 0.1, 0.6), (1.52, 0.1, 0.1),
])  # fmt: skip
def test_walks_agree(ior, joint, metal):
    scores = z_scores(*compared(coats(ior, joint, metal), POINTS, COSINES, is_sheet=False, samples=1 << 19))
    assert np.abs(scores).max() < z_limit(4 * len(scores))

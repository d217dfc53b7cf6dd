# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that facets spread and that crosses a layer without scattering, against photons, by distance from the beam."""

import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Medium, Retroreflector, Stack

CLEAR = Medium(sigma_s=1e-6, sigma_a=0.05, thickness=1.0)
HAZY = Medium(sigma_s=0.3, sigma_a=0.05, thickness=1.0, phase=HenyeyGreenstein(0.3))
RADII = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 1.0]


def differences(stack, transmitted):
    """(differences of the flux within each radius, standard errors, the searchlight)."""
    beam = lamina.searchlight(stack)
    photons = lamina.estimate_searchlight(stack, samples=200_000, r=RADII)
    found, walked = (one.transmitted_inside if transmitted else one.reflected_inside for one in (beam, photons))
    return np.ravel(found(RADII)) - np.ravel(walked.value), np.ravel(walked.stderr), beam


@pytest.mark.parametrize(("layers", "base", "transmitted"), [
    ([Interface(1.5, 0.15), CLEAR, Interface(1.0)], None, True),
    ([Interface(1.5, 0.15), CLEAR, Interface(1.0)], None, False),
    ([Interface(1.5, 0.15), CLEAR, Interface(1.0, 0.15)], None, True),
    ([CLEAR], Conductor(eta=0.5, k=3.0, alpha=0.1), False), ([CLEAR], Conductor(eta=0.5, k=3.0, alpha=0.3), False),
    ([CLEAR], Retroreflector(0.8, 0.2), False), ([Interface(1.4), CLEAR], Conductor(eta=0.5, k=3.0, alpha=0.3), False)],
    ids=["etched plate", "reflected by an etched plate", "etched on both sides", "metal", "rough metal",
         "retroreflector", "below varnish"])  # fmt: skip
def test_clear_layers(layers, base, transmitted):
    """Before, up to half of all light was missing near the beam, and profiles were negative."""
    difference, stderr, beam = differences(Stack(layers, base), transmitted)
    assert (np.abs(difference) < z_limit(len(RADII) * 7) * stderr + 3e-4).all(), difference
    profile = np.ravel(beam.transmitted_profile(RADII) if transmitted else beam.profile(RADII))
    assert (profile > 0.0).all()


@pytest.mark.parametrize("alpha", [0.05, 0.2])
def test_a_layer_that_scatters(alpha):
    """Light that facets spread and a medium then scatters still travels in discrete directions."""
    difference, stderr, _ = differences(Stack([Interface(1.5, alpha), HAZY, Interface(1.0)]), True)
    assert (np.abs(difference) < 4.0 * stderr + 4e-3).all(), difference

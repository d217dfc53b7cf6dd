# SPDX-License-Identifier: GPL-3.0-or-later
"""Light by direction from its moments, on a quadrature of the tests' own."""

import numpy as np
import pytest

from lamina import Surface
from lamina.common.fresnel import fresnel
from lamina.maps.exponential import exponential

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
COSINES, AZIMUTHS = 0.5 * (NODES + 1.0), 2.0 * np.pi * np.arange(48) / 48
SHARES = np.repeat(WEIGHTS * COSINES, 48) / 48  # of directions in cosine-weighted means
MATCHED = Surface()
NORMALS = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [2 / 3, -2 / 3, 1 / 3]])
LOBES = {"even": (lambda up, a: 1.0 + 0.0 * a, 1e-6), "diffuse": (lambda up, a: 1.0 + 1.5 * up, 0.02),
         "lobe": (lambda up, a: np.exp(3.0 * a), 0.04), "lobe on light": (lambda up, a: 1.0 + np.exp(4.0 * a), 0.05),
         "dark middle": (lambda up, a: 1.2 - up * up, 0.08)}


def directions(normal):
    """(n, 3), over the hemisphere."""
    tangent = np.cross(normal, [0.3, 0.9, 0.1])
    tangent /= np.linalg.norm(tangent)
    across = np.sqrt(1.0 - COSINES**2)
    x, y = np.outer(across, np.cos(AZIMUTHS)).ravel(), np.outer(across, np.sin(AZIMUTHS)).ravel()
    return np.column_stack([x, y, np.repeat(COSINES, 48)]) @ [tangent, np.cross(normal, tangent), normal]


def terms(w):
    x, y, z = w.T
    return np.column_stack([x, y, z, x * x, y * y, x * y, y * z, z * x])


def shown(light, boundary=MATCHED, error=0.0):
    """For each normal: (what the exponential shows, light), by direction."""
    pairs = []
    for normal in NORMALS:
        w = directions(normal)
        up, passed = w @ normal, 1.0 - fresnel(w @ normal, boundary.ior)
        given = light(up, w @ [0.36, 0.48, 0.8]) * passed
        mean, moments = SHARES @ given, (SHARES * given) @ terms(w)
        found = exponential(np.array([[mean]]), np.array([[error * mean]]), moments[None, None], normal[None],
                            boundary)
        assert found.shape == (1, 1, 9)
        pairs.append((mean * np.exp(terms(w) @ found[0, 0, :8] + found[0, 0, 8]) * passed, given))
    return pairs


@pytest.mark.parametrize("boundary", [Surface(), Surface(1.5)])
@pytest.mark.parametrize("name", LOBES)
def test_light_is_found_from_its_moments(name, boundary):
    light, tolerance = LOBES[name]
    for found, given in shown(light, boundary):
        assert SHARES @ found == pytest.approx(SHARES @ given, rel=1e-5)
        assert np.sqrt(SHARES @ (found - given) ** 2) < tolerance * (SHARES @ given)


def test_uncertain_light_depends_less_on_the_direction():
    light, _ = LOBES["lobe"]
    steepness = []
    for error in (0.0, 0.3, 1.0, 1e6):
        found, _ = shown(light, error=error)[0]
        steepness.append(np.std(np.log(found)))
    assert steepness[0] > steepness[1] > 1.5 * steepness[2] and steepness[3] < 1e-6


def test_dark_and_impossible_moments():
    """Without light, and with moments of noise that belong to no light, the function is finite and has its mean."""
    moments = np.array([np.zeros(8), np.full(8, 3.0), [0.0, 0.0, -0.9, 0.0, 0.0, 0.0, 0.0, 0.0]])[:, None]
    normals = np.repeat(NORMALS[:1], 3, axis=0)
    found = exponential(np.array([[0.0], [1.0], [1.0]]), np.full((3, 1), 0.1), moments, normals, Surface())
    w = directions(NORMALS[0])
    light = np.exp(terms(w) @ found[:, 0, :8].T + found[:, 0, 8])
    np.testing.assert_allclose(SHARES @ light, 1.0, rtol=2e-3)
    np.testing.assert_allclose(light[:, 0], 1.0, rtol=1e-12)
    assert np.isfinite(found).all()

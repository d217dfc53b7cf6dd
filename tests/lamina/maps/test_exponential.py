# SPDX-License-Identifier: GPL-3.0-or-later
"""Light by direction from its moments, on a quadrature of the tests' own."""

import numpy as np
import pytest

from lamina import Surface
from lamina.common.fresnel import fresnel
from lamina.maps.exponential import even_moments, exponential
from lamina.walks.searchlight_moments import Measured

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


def excess_of(light, boundary=MATCHED):
    """For each normal: (directions, light, mean, excess of its moments)."""
    for normal in NORMALS:
        w = directions(normal)
        given = light(w @ normal, w @ [0.36, 0.48, 0.8]) * (1.0 - fresnel(w @ normal, boundary.ior))
        mean, moments = SHARES @ given, (SHARES * given) @ terms(w)
        yield w, given, mean, moments - mean * even_moments(normal[None], boundary)[0]


def shown(light, boundary=MATCHED, error=0.0):
    """For each normal, as the only point of a map: (what the exponential shows, light), by direction."""
    pairs = []
    for (w, given, mean, excess), normal in zip(excess_of(light, boundary), NORMALS, strict=True):
        measured = Measured(excess[None, None], np.full((1, 1, 8), error))
        found = exponential(np.array([[mean]]), measured, normal[None], boundary)
        assert found.shape == (1, 1, 9)
        passed = 1.0 - fresnel(w @ normal, boundary.ior)
        pairs.append((mean * np.exp(terms(w) @ found[0, 0, :8] + found[0, 0, 8]) * passed, given))
    return pairs


@pytest.mark.parametrize("boundary", [Surface(), Surface(1.5)])
@pytest.mark.parametrize("name", LOBES)
def test_light_is_found_from_its_moments(name, boundary):
    light, tolerance = LOBES[name]
    for found, given in shown(light, boundary):
        assert SHARES @ found == pytest.approx(SHARES @ given, rel=1e-5)
        assert np.sqrt(SHARES @ (found - given) ** 2) < tolerance * (SHARES @ given)


@pytest.mark.parametrize("boundary", [MATCHED, Surface(1.5)])
def test_even_light_has_no_excess(boundary):
    for _, _, mean, excess in excess_of(lambda up, a: 2.0 + 0.0 * a, boundary):
        np.testing.assert_allclose(excess, 0.0, atol=2e-6 * mean)


def test_noise_is_drawn_to_the_mean_over_points():
    """Points with moments from 20 paths each; some points have light of another shape."""
    rng, normal, paths = np.random.default_rng(3), NORMALS[0], 20
    w, even = directions(normal), even_moments(NORMALS[:1], MATCHED)[0]
    up, a = w @ normal, w @ [0.36, 0.48, 0.8]
    shapes = [light / (SHARES @ light) for light in (1.0 + 1.5 * up, np.exp(3.0 * a))]
    is_lobe = np.arange(400) < 40
    given = np.where(is_lobe[:, None], shapes[1], shapes[0])
    drawn = rng.choice(len(w), (400, paths), p=SHARES / SHARES.sum())
    light = np.take_along_axis(given, drawn, axis=1)[..., None] * terms(w)[drawn]
    excess = light.mean(axis=1) - even * np.take_along_axis(given, drawn, axis=1).mean(axis=1, keepdims=True)
    errors = []
    for stderr in (np.zeros((400, 8)), light.std(axis=1) / np.sqrt(paths - 1)):
        measured = Measured(excess[:, None], stderr[:, None])
        found = exponential(np.ones((400, 1)), measured, np.repeat(NORMALS[:1], 400, axis=0), MATCHED)[:, 0]
        shown = np.exp(found[:, :8] @ terms(w).T + found[:, 8:])
        np.testing.assert_allclose(shown @ SHARES, 1.0, rtol=1e-3)
        errors.append(np.sqrt((shown - given) ** 2 @ SHARES))
    plain, sure = errors
    assert sure[~is_lobe].mean() < 0.5 * plain[~is_lobe].mean() and sure[is_lobe].mean() < plain[is_lobe].mean()


def test_dark_and_impossible_moments():
    """Without light, and with moments of noise that belong to no light, the function is finite and has its mean."""
    excess = np.array([np.zeros(8), np.full(8, 3.0), [0.0, 0.0, -0.9, 0.0, 0.0, 0.0, 0.0, 0.0]])[:, None]
    normals = np.repeat(NORMALS[:1], 3, axis=0)
    found = exponential(np.array([[0.0], [1.0], [1.0]]), Measured(excess, 0.0 * excess), normals, MATCHED)
    w = directions(NORMALS[0])
    light = np.exp(terms(w) @ found[:, 0, :8].T + found[:, 0, 8])
    np.testing.assert_allclose(SHARES @ light, 1.0, rtol=2e-3)
    np.testing.assert_allclose(light[:, 0], 1.0, rtol=1e-12)
    assert np.isfinite(found).all()

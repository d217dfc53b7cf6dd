# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured bases, against the functions from which their tables were made, against walks, and in JSON."""

import base64
import math

import numpy as np
import pytest
from measured_tables import facets, measured, vectors

import lamina
from lamina import HenyeyGreenstein, Interface, Lambert, Measured, Medium, Stack, StackError

# Width of the facets, reflectance at normal incidence, reflectance of the Lambert surface
LOBES = {"narrow": (0.03, 0.6, 0.0), "varnish": (0.1, 0.04, 0.3), "metal": (0.3, 0.9, 0.0), "matt": (1.0, 0.0, 0.4)}
PAINT = LOBES["varnish"]
DUST = Medium(albedo=0.9, tau=0.3, phase=HenyeyGreenstein(0.5))
MOST_Z = 4.0


def even(reflectance):
    """The function of a Lambert surface."""
    return lambda wi, wo: np.full(wi.shape[:-1], reflectance / math.pi)


def directions(count, least):
    rng = np.random.default_rng(1)
    mu_o, mu_i, dphi = rng.uniform(least, 1.0, (3, count))
    return mu_o, mu_i, math.pi * dphi


@pytest.mark.parametrize("lobe", LOBES.values(), ids=LOBES)
def test_a_bare_base_returns_what_was_measured(lobe):
    solved = lamina.solve(Stack([], measured(facets(*lobe))))
    mu_o, mu_i, dphi = directions(400, 0.1)
    values = solved.brdf(mu_o, mu_i, dphi)[:, 0]
    errors = values / facets(*lobe)(*vectors(mu_o, mu_i, dphi)) - 1.0
    assert np.sqrt(np.mean(errors**2)) < 5e-4 and np.abs(errors).max() < 5e-3
    # About the mirror direction, where narrow lobes lie
    rng = np.random.default_rng(2)
    mu_o, dphi = np.clip(mu_i + 0.5 * lobe[0] * rng.normal(size=400), 0.1, 1.0), np.abs(lobe[0] * rng.normal(size=400))
    errors = solved.brdf(mu_o, mu_i, dphi)[:, 0] / facets(*lobe)(*vectors(mu_o, mu_i, dphi)) - 1.0
    assert np.sqrt(np.mean(errors**2)) < 1e-3
    assert solved.brdf(mu_i, mu_o, dphi) == pytest.approx(solved.brdf(mu_o, mu_i, dphi), rel=1e-6)


@pytest.mark.parametrize("lobe", LOBES.values(), ids=LOBES)
def test_the_albedo_of_a_bare_base(lobe):
    """Against sums over directions of light about the mirror direction and about the normal."""
    solved = lamina.solve(Stack([], measured(facets(*lobe))))
    for mu in (0.2, 0.5, 0.9):
        # Half vectors: the directions mirrored at them have the density 4 (light . half)
        x, w = np.polynomial.legendre.leggauss(600)
        end = math.asinh(math.tan(1.56) / lobe[0])
        slope = lobe[0] * np.sinh(0.5 * end * (x + 1.0))
        step = 0.5 * end * w * lobe[0] * np.cosh(0.5 * end * (x + 1.0)) / (1.0 + slope**2)
        tilt, turn = (one.ravel() for one in np.meshgrid(np.arctan(slope), (np.arange(600) + 0.5) * math.pi / 300))
        half = np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1)
        wi = np.array([-math.sqrt(1.0 - mu * mu), 0.0, mu])
        along = half @ wi
        wo = 2.0 * along[:, None] * half - wi
        seen = (along > 0.0) & (wo[:, 2] > 0.0)
        size = (np.tile(step, 600) * math.pi / 300 * np.sin(tilt) * 4.0 * along * wo[:, 2])[seen]
        whole = size @ facets(*lobe)(np.broadcast_to(wi, wo.shape)[seen], wo[seen])
        assert solved.reflectance(mu)[0] == pytest.approx(whole, rel=1e-3)


STACKS = {
    "dusty": [DUST], "under a coat": [Interface(1.5)], "under a rough coat": [Interface(1.4, alpha=0.3)],
    "dust on a coat": [DUST, Interface(1.5), Medium(albedo=0.5, tau=0.2)],
}


@pytest.mark.parametrize("layers", STACKS.values(), ids=STACKS)
@pytest.mark.parametrize("lobe", [PAINT, (0.3, 0.9, 0.0)], ids=["varnish", "metal"])
def test_walks_agree(layers, lobe):
    stack = Stack(layers, measured(facets(*lobe)))
    solved = lamina.solve(stack)
    for mu_o, mu_i, dphi in ((0.7, 0.5, 1.0), (0.8, 0.75, 0.2), (0.4, 0.9, math.pi)):
        found = lamina.estimate(stack, mu_o, mu_i, dphi, method="transfer", samples=60_000, seed=3)
        assert np.abs((found.value - solved.brdf(mu_o, mu_i, dphi)) / found.stderr).max() < MOST_Z
        assert found.stderr[0] < 0.03 * found.value[0]
    found = lamina.estimate(stack, None, 0.5, method="transfer", samples=60_000, seed=4)
    assert np.abs((found.value - solved.reflectance(0.5)) / found.stderr).max() < MOST_Z


def test_a_measured_lambert_surface_is_a_lambert_surface():
    """Below layers, by code that knows Lambert surfaces without any table."""
    stacks = [Stack([Interface(1.5), DUST], base) for base in (measured(even(0.5)), Lambert(0.5))]
    first, second = map(lamina.solve, stacks)
    mu_o, mu_i, dphi = directions(100, 0.1)
    assert first.brdf(mu_o, mu_i, dphi) == pytest.approx(second.brdf(mu_o, mu_i, dphi), rel=2e-3)
    assert first.reflectance([0.2, 0.9]) == pytest.approx(second.reflectance([0.2, 0.9]), rel=5e-4)
    milk = Medium(sigma_s=1.0, sigma_a=0.1, thickness=1.0)
    beams = [lamina.searchlight(Stack([milk], stack.base)) for stack in stacks]
    assert beams[0].reflectance == pytest.approx(beams[1].reflectance, rel=2e-3)


def test_channels_are_those_of_the_table():
    lobes = [facets(0.2, one, 0.1) for one in (0.1, 0.2, 0.4)]
    solved = lamina.solve(Stack([DUST], measured(*lobes)))
    for channel, lobe in enumerate(lobes):
        alone = lamina.solve(Stack([DUST], measured(lobe)))
        assert solved.brdf(0.6, 0.7, 0.4)[channel] == pytest.approx(alone.brdf(0.6, 0.7, 0.4)[0], rel=2e-4)


def test_json_holds_the_table_and_the_hash_names_it():
    base = measured(facets(*PAINT), name="blue paint")
    stack = Stack([DUST], base)
    again = Stack.from_json(stack.to_json())
    assert again == stack and again.base.name == "blue paint" and again.hash == stack.hash
    assert Stack([DUST], Measured(base.table, "another name")).hash == stack.hash
    assert Stack([DUST], measured(facets(0.1, 0.04, 0.31))).hash != stack.hash
    assert len(base.table) < 80_000


def test_what_is_not_a_table_is_refused():
    table = measured(facets(*PAINT)).table
    raw = base64.b64decode(table)
    wrong = {"": "missing", "abc": "not a table", table[:-8]: "truncated", 5: "must be a text",
             base64.b64encode(b"LMB2" + raw[4:]).decode(): "newer Lamina",
             base64.b64encode(raw[:5] + b"\xff" * 8 + raw[13:]).decode(): "out of range"}
    for text, words in wrong.items():
        with pytest.raises(StackError, match=rf"^base\.table.*{words}"):
            Stack([], Measured(text))
    with pytest.raises(StackError, match=r"^base\.name = 5: must be a text"):
        Stack([], Measured(table, 5))


def test_what_lies_above_is_refused_early():
    base = measured(facets(*PAINT))
    with pytest.raises(StackError, match=r"^base\.kind = 'measured': has red, green and blue"):
        Stack([DUST], base, wavelengths=[500.0, 600.0])
    with pytest.raises(StackError, match=r"^base\.kind = 'measured': must be another kind below anisotropic facets"):
        lamina.solve(Stack([Interface(1.5, alpha=0.1, alpha_v=0.3)], base))


def test_a_table_that_gains_light_is_refused():
    with pytest.raises(lamina.SolveError, match="a measured base gains"):
        lamina.solve(Stack([], measured(even(1.1))))

# SPDX-License-Identifier: GPL-3.0-or-later
"""Flakes with thin films: against random walks, sums over the normals of flakes with the package tmm, energy,
reciprocity, limits, refusals."""

import math

import numpy as np
import pytest
import tmm
from solver_and_walks import compared, exchanged, z_scores
from z_limit import z_limit

import lamina
from lamina import Film, Flakes, Interface, Lambert, SolveError, Stack

COAT = Interface(1.5)
MU = np.array([0.06, 0.3, 0.6, 0.95])
POINTS = [(1.0, 0.9, 0.0), (0.9, 0.5, 0.0), (0.7, 0.7, 0.3), (0.5, 0.3, 1.0), (0.2, 0.6, math.pi), (0.8, 0.2, 2.0)]
TIO2, MICA, NM = 2.5, 1.58, [420.0, 550.0, 680.0]
OXIDE = 2.3 + 0.4j
TWO = [Film(1.46, 100.0), Film(TIO2, 120.0)]


def pigment(thickness, tau=1.0, alpha=0.2, **more):
    return Flakes(tau, alpha, film=Film(TIO2, thickness), **more)


STACKS = {
    "bare over black": Stack([pigment(120.0)], Lambert(0.0), wavelengths=NM),
    "sheet": Stack([pigment(80.0, 2.0, 0.3)], wavelengths=NM),
    "under a smooth coat": Stack([COAT, pigment(120.0, 2.0)], Lambert(0.3), wavelengths=NM),
    "under a rough coat": Stack([Interface(1.5, 0.2), pigment(100.0, 2.0)], Lambert(0.05), wavelengths=NM),
    "in a tinted binder": Stack([COAT, pigment(160.0, 3.0, binder=[0.1, 0.4, 1.0])], Lambert(0.8), wavelengths=NM),
    "films that absorb": Stack([COAT, Flakes(1.5, 0.2, film=Film(OXIDE, 60.0))], Lambert(0.5), wavelengths=NM),
    "two films": Stack([COAT, Flakes(2.0, 0.25, film=TWO)], Lambert(0.1), wavelengths=NM),
    "platelets of glass": Stack([Flakes(3.0, 0.3, ior=1.52)], Lambert(0.5), wavelengths=NM),
    "on metal": Stack([Flakes(1.0, 0.2, eta=1.2, k=6.5, film=[Film(3.1 + 3.3j, 8.0), Film(1.7, 180.0)])],
                      Lambert(0.1), wavelengths=NM),
    "thick": Stack([COAT, pigment(120.0, 30.0)], wavelengths=NM),
}


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_against_walks(stack):
    """Walks share what a flake reflects and passes with the solver, which the sums below test, and the area that takes
    light."""
    is_sheet = stack.base is None and not isinstance(stack.layers[0], Interface)
    value, walk, error = compared(stack, POINTS, MU, is_sheet)
    assert np.abs(z_scores(value, walk, error)).max() < z_limit(value.size)
    assert np.median(error / walk) < 0.01  # the walks see errors of this size


def shares(films, platelet, cosine, nm, binder=1.0):
    """(R, T) of a platelet by tmm, incoherent between its faces, for unpolarised light."""
    coats = [complex(film.ior, film.k) for film in films]
    indices = [binder, *coats, platelet, *coats[::-1], binder]
    depths = [film.thickness for film in films]
    depths = [math.inf, *depths, 1e6, *depths[::-1], math.inf]
    kinds = ["i", *"c" * len(films), "i", *"c" * len(films), "i"]
    both = [tmm.inc_tmm(pol, indices, depths, kinds, math.acos(cosine), nm) for pol in "sp"]
    return tuple(0.5 * sum(one[name] for one in both) for name in ("R", "T"))


LAYERS = {"one film": [Film(TIO2, 120.0)], "two films": TWO, "absorbing": [Film(OXIDE, 60.0)], "none": []}


@pytest.mark.parametrize("films", LAYERS.values(), ids=LAYERS)
def test_a_thin_layer_reflects_once(films):
    """By the normal of the one flake, its density after Heitz et al. 2015, and tmm."""
    tau, alpha = 1e-5, 0.3
    solved = lamina.solve(Stack([Flakes(tau, alpha, ior=MICA, film=films)], Lambert(0.0), wavelengths=NM))
    for o, i, dphi in POINTS:
        out = np.array([math.sqrt(1 - o**2) * math.cos(dphi), math.sqrt(1 - o**2) * math.sin(dphi), o])
        to_light = np.array([-math.sqrt(1 - i**2), 0.0, i])
        half = (out + to_light) / np.linalg.norm(out + to_light)
        stretched = half / [alpha, alpha, 1.0]
        density = 1.0 / (math.pi * alpha**2 * (stretched @ stretched) ** 2)
        wanted = [tau * density * shares(films, MICA, min(1.0, half @ out), nm)[0] / (4.0 * o * i) for nm in NM]
        assert solved.brdf(o, i, dphi) == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize("films", LAYERS.values(), ids=LAYERS)
def test_what_a_beam_loses(films):
    """The sum over normals of the area of each flake and of what it does not pass, by tmm."""
    tau, alpha, cosines = 0.8, 0.3, np.array([0.3, 0.8])
    solved = lamina.solve(Stack([Flakes(tau, alpha, ior=MICA, film=films)], wavelengths=NM))
    nodes, weights = np.polynomial.legendre.leggauss(400)
    height, weight = 0.5 * (nodes + 1.0), 0.5 * weights
    turn = np.pi * (np.arange(400) + 0.5) / 400
    density = alpha**2 / (math.pi * (alpha**2 * height**2 + 1.0 - height**2) ** 2)
    steps = np.linspace(1e-4, 1.0, 400)
    for channel, nm in enumerate(NM):
        taken = [1.0 - shares(films, MICA, c, nm)[1] for c in steps]
        for mu in cosines:
            shown = np.abs(height[:, None] * mu + np.sqrt(1.0 - height**2)[:, None] * math.sqrt(1.0 - mu**2)
                           * np.cos(turn))
            area = 2.0 * math.pi * (weight * density * (shown * np.interp(shown, steps, taken)).mean(1)).sum()
            beam = solved.transmittance(mu, parts=True)[1][channel]
            assert beam == pytest.approx(math.exp(-tau * area / mu), rel=2e-4)


@pytest.mark.parametrize("alpha", [0.15, 0.2, 0.5])
@pytest.mark.parametrize("tau", [0.1, 3.0, 30.0])
def test_energy_of_clear_films(alpha, tau):
    for film in ([Film(TIO2, 120.0)], TWO):
        solved = lamina.solve(Stack([Flakes(tau, alpha, film=film)], wavelengths=[550.0]))
        assert np.allclose(solved.reflectance(MU) + solved.transmittance(MU), 1.0, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_reciprocity(stack):
    values, others = exchanged(stack, MU)
    assert np.allclose(values, others, rtol=1e-4)
    assert np.all(values > 0.0)


def test_a_film_of_no_thickness_is_none():
    def values(film):
        return lamina.solve(Stack([COAT, Flakes(2.0, 0.3, ior=MICA, film=film)], Lambert(0.3), wavelengths=NM)).brdf(
            MU[:, None], MU, 0.5)

    assert np.allclose(values([Film(TIO2, 0.0)]), values([]), rtol=1e-12)


def test_metal_under_a_film_of_no_thickness():
    def values(**film):
        metal = Flakes(1.0, 0.3, eta=0.2, k=3.2, **film)
        return lamina.solve(Stack([COAT, metal], Lambert(0.3), wavelengths=NM)).brdf(MU[:, None], MU, 0.5)

    assert np.allclose(values(film=Film(TIO2, 0.0)), values(), rtol=1e-3)  # two fits of Fresnel's factor


def test_the_color_turns_with_the_angle():
    """Red and blue change places between steep and grazing light, as in flip-flop pigments."""
    solved = lamina.solve(Stack([Flakes(1.0, 0.1, film=Film(TIO2, 110.0))], Lambert(0.0), wavelengths=NM))
    steep, grazing = solved.brdf(0.98, 0.98, 0.0), solved.brdf(0.4, 0.4, 0.0)
    assert steep[0] / steep[2] > 1.3 * grazing[0] / grazing[2]


@pytest.mark.parametrize(("solved", "refused"), [
    (Flakes(1.0, 0.2, film=Film(2.5, 600.0)), Flakes(1.0, 0.2, film=Film(2.5, 700.0))),
    (Flakes(1.0, 0.2, film=Film(1.38, 200.0)), Flakes(1.0, 0.2, film=Film(1.38, 300.0))),
    (Flakes(1.0, 0.2, metal="aluminium", film=Film(1.38, 1000.0)), None),
])
def test_thick_films_in_lacquer(solved, refused):
    """The examples of docs/limits.md."""
    lamina.solve(Stack([Interface(1.5), solved], Lambert(0.1)), "preview")
    if refused is not None:
        with pytest.raises(SolveError, match="changes too fast with the angle"):
            lamina.solve(Stack([Interface(1.5), refused], Lambert(0.1)), "preview")


@pytest.mark.parametrize(("flakes", "words"), [
    (Flakes(1.0, 0.3, film=Film(TIO2, 3000.0)), "changes too fast with the angle"),
    (Flakes(1.0, 0.3, ior=1.4), "changes too fast with the angle"),
    (Flakes(1.0, 0.3, ior=1.5), "reflect next to nothing"),
])
def test_what_cannot_be_solved(flakes, words):
    with pytest.raises(SolveError, match=words):
        lamina.solve(Stack([COAT, flakes], wavelengths=[550.0]))

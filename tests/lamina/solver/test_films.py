# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films: against the package tmm, energy, random walks, the mean over the spectrum of a channel, refusals."""

import numpy as np
import pytest
import tmm
from z_limit import z_limit

import lamina
from lamina import Conductor, Film, HenyeyGreenstein, Interface, Lambert, Medium, Spectrum, Stack, StackError
from lamina.common.observer import rec709_under

MU = np.array([0.05, 0.2, 0.5, 0.8, 1.0])
NM = [450.0, 550.0, 650.0]
TIO2, OXIDE = 2.4, 2.3 + 0.4j
FILMS = {
    "anti-reflex": [Film(1.38, 100.0)],
    "high index": [Film(TIO2, 60.0)],
    "absorbing": [Film(OXIDE, 45.0)],
    "air gap": [Film(1.0, 300.0)],
    "two": [Film(1.38, 90.0), Film(TIO2, 120.0)],
    "mirror": [Film(TIO2, 57.0), Film(1.46, 94.0), Film(TIO2, 57.0), Film(1.46, 94.0), Film(TIO2, 57.0)],
    "silver": [Film(0.06 + 3.6j, 30.0)],
    "thick": [Film(1.6, 5000.0)],
    "nothing": [Film(1.7, 0.0)],
}


def shares(films, above, below, mu, nm):
    """(R, T) by tmm for unpolarised light at cosine `mu` in the medium above."""
    indices = [above, *(complex(film.ior, film.k) for film in films), below]
    depths = [np.inf, *(film.thickness for film in films), np.inf]
    both = [tmm.coh_tmm(pol, indices, depths, np.arccos(mu), nm) for pol in "sp"]
    return tuple(0.5 * sum(one[name] for one in both) for name in ("R", "T"))


def table(films, above, below, mus=MU):
    """Reflectances and transmittances, [cosine, wavelength]."""
    found = np.array([[shares(films, above, below, mu, nm) for nm in NM] for mu in mus])
    return found[..., 0], found[..., 1]


@pytest.mark.parametrize("films", FILMS.values(), ids=FILMS)
def test_films_on_glass(films):
    solved = lamina.solve(Stack([*films, Interface(1.5)], wavelengths=NM))
    reflected, passed = table(films, 1.0, 1.5)
    assert np.allclose(solved.reflectance(MU), reflected, rtol=0.0, atol=1e-10)
    assert np.allclose(solved.transmittance(MU), passed, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("films", FILMS.values(), ids=FILMS)
def test_films_on_metal(films):
    """Bare, and below a clear lacquer, whose index is then that above the films."""
    metal = Conductor(eta=[1.9, 2.5, 2.8], k=[2.6, 2.9, 3.2])
    solved = lamina.solve(Stack(films, metal, wavelengths=NM))
    indices = [complex(*pair) for pair in zip(metal.eta, metal.k, strict=True)]
    bare = [[shares(films, 1.0, below, mu, nm)[0] for nm, below in zip(NM, indices, strict=True)] for mu in MU]
    assert np.allclose(solved.reflectance(MU), bare, rtol=0.0, atol=1e-10)
    lacquered = lamina.solve(Stack([Interface(1.5), *films], metal, wavelengths=NM)).reflectance(MU)
    inside = np.sqrt(1.0 - (1.0 - MU**2) / 1.5**2)
    below = np.array([[shares(films, 1.5, one, mu, nm)[0] for nm, one in zip(NM, indices, strict=True)]
                      for mu in inside])
    coat = np.array([shares([], 1.0, 1.5, mu, 500.0)[0] for mu in MU])[:, None]
    assert np.allclose(lacquered, coat + (1.0 - coat) ** 2 * below / (1.0 - coat * below), rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("films", FILMS.values(), ids=FILMS)
def test_films_on_both_faces_of_tinted_glass(films):
    """Incoherent in the glass: light that returns meets the films from below."""
    stack = Stack([*films, Interface(1.5), Medium(albedo=0.0, tau=0.2), *reversed(films), Interface(1.0)],
                  wavelengths=NM)
    solved = lamina.solve(stack)
    inside = np.sqrt(1.0 - (1.0 - MU**2) / 1.5**2)
    above, passed = table(films, 1.0, 1.5)
    within, _ = table(films[::-1], 1.5, 1.0, inside)
    crossing = np.exp(-0.2 / inside)[:, None]
    between = 1.0 / (1.0 - (within * crossing) ** 2)
    assert np.allclose(solved.reflectance(MU), above + passed**2 * within * crossing**2 * between, rtol=0.0, atol=1e-10)
    assert np.allclose(solved.transmittance(MU), passed**2 * crossing * between, rtol=0.0, atol=1e-10)
    assert np.allclose(solved.reflectance(MU), solved.reflectance(MU, side="bottom"), rtol=0.0, atol=1e-12)


def test_the_package_tmm_agrees_on_incoherent_glass():
    film = Film(OXIDE, 80.0)
    solved = lamina.solve(Stack([film, Interface(1.5), Interface(1.0)], wavelengths=NM))
    for channel, nm in enumerate(NM):
        found = tmm.inc_tmm("s", [1.0, OXIDE, 1.5, 1.0], [np.inf, 80.0, 1e6, np.inf], ["i", "c", "i", "i"], 0.0, nm)
        assert solved.reflectance(1.0)[channel] == pytest.approx(found["R"], abs=1e-10)
        assert solved.transmittance(1.0)[channel] == pytest.approx(found["T"], abs=1e-10)


def test_a_soap_film_between_equal_indices():
    soap = lamina.solve(Stack([Film(1.33, 400.0), Interface(1.0)], wavelengths=NM))
    reflected, passed = table([Film(1.33, 400.0)], 1.0, 1.0)
    assert np.allclose(soap.reflectance(MU), reflected, rtol=0.0, atol=1e-10)
    assert np.allclose(soap.transmittance(MU, parts=True)[1], passed, rtol=0.0, atol=1e-10)


def test_clear_films_neither_lose_nor_gain():
    """White medium between films, smooth and rough; smooth to 1e-9."""
    white = Medium(albedo=1.0, tau=1.5, phase=HenyeyGreenstein(0.4))
    for alpha, allowed in ((0.0, 1e-9), (0.3, 2e-4)):
        films = [Film(TIO2, 60.0), Film(1.38, 100.0)]
        stack = Stack([*films, Interface(1.5, alpha), white, Film(1.38, 100.0), Interface(1.0)], wavelengths=NM)
        solved = lamina.solve(stack)
        for side in ("top", "bottom"):
            kept = solved.reflectance(MU[1:], side) + solved.transmittance(MU[1:], side)
            assert np.allclose(kept, 1.0, rtol=0.0, atol=allowed)


WALKED = {
    "smooth absorbing film over a medium": Stack(
        [Film(0.06 + 3.6j, 20.0), Interface(1.5), Medium(albedo=0.9, tau=1.0)], Lambert(0.6), wavelengths=[550.0]),
    "rough clear film over a medium": Stack(
        [Film(TIO2, 70.0), Interface(1.5, 0.3), Medium(albedo=0.9, tau=1.0)], Lambert(0.6), wavelengths=[550.0]),
    "rough absorbing film over a medium": Stack(
        [Film(OXIDE, 70.0), Interface(1.5, 0.3), Medium(albedo=0.9, tau=1.0)], Lambert(0.6), wavelengths=[550.0]),
    "rough oxide below lacquer": Stack(
        [Interface(1.5), Film(OXIDE, 45.0)], Conductor(2.9, 3.0, alpha=0.3), wavelengths=[550.0]),
    "brushed oxide": Stack([Film(TIO2, 45.0)], Conductor(2.9, 3.0, alpha=0.1, alpha_v=0.4), wavelengths=[550.0]),
}


@pytest.mark.parametrize("stack", WALKED.values(), ids=WALKED)
def test_walks_agree_with_the_solver(stack):
    solved = lamina.solve(stack)
    pairs = [(0.9, 0.8, 0.3), (0.5, 0.6, 2.0), (0.3, 0.4, 0.0)]
    for mu_o, mu_i, dphi in pairs:
        walked = lamina.estimate(stack, mu_o, mu_i, dphi, method="transfer", samples=40000, seed=7)
        value = solved.brdf(mu_o, mu_i, dphi)
        allowed = z_limit(len(pairs) * len(WALKED)) * walked.stderr + 3e-3 * value
        assert np.all(np.abs(walked.value - value) < allowed)


def test_a_channel_is_the_mean_over_its_spectrum():
    """Of each wavelength's reflectance, as linear Rec. 709 under D65, from a film whose index depends on wavelength."""
    index = Spectrum([400.0, 500.0, 700.0], [2.7 + 0.1j, 2.5, 2.3])
    gold = Conductor(eta=[0.2, 0.5, 1.4], k=[3.2, 2.4, 1.9])
    solved = lamina.solve(Stack([Film(index, 120.0)], gold)).reflectance(MU)
    wavelengths, weights = rec709_under()
    for channel in range(3):
        below = complex(gold.eta[channel], gold.k[channel])
        own = np.interp(wavelengths, index.wavelengths, np.real(index.values)) + 1j * np.interp(
            wavelengths, index.wavelengths, np.imag(index.values))
        for row, mu in enumerate(MU):
            rows = [0.5 * sum(tmm.coh_tmm(pol, [1.0, n, below], [np.inf, 120.0, np.inf], np.arccos(mu), nm)["R"]
                              for pol in "sp") for nm, n in zip(wavelengths, own, strict=True)]
            assert solved[row, channel] == pytest.approx(np.clip(weights[channel] @ rows, 0.0, 1.0), abs=1e-10)


def test_a_film_is_read_back_and_changes_the_hash():
    stack = Stack([Film(Spectrum([400, 700], [1.5, 1.4]), 120.0, k=0.1, name="oil"), Interface(1.33)], Lambert(0.1))
    again = Stack.from_json(stack.to_json())
    assert again == stack and again.hash == stack.hash and stack.channels == 3
    assert stack.hash != Stack([Interface(1.33)], Lambert(0.1)).hash
    assert Film(1.5 + 0.1j, 10.0) == Film(1.5, 10.0, k=0.1)
    white = Stack([Film(1.5, 120.0)], Conductor(2.0, 3.0))
    assert Stack.from_json(Stack(white.layers, white.base, wavelengths=NM).to_json()).wavelengths == tuple(NM)
    assert white.hash != Stack(white.layers, white.base, wavelengths=NM).hash


def test_the_film_of_a_varying_interface_goes_with_it():
    stack = Stack([Film(1.5, 120.0), Interface(1.33, varying=True), Medium(0.0, 0.1), Film(TIO2, 40.0)],
                  Conductor(2.0, 3.0))
    assert stack.uncovered.layers == (Film(TIO2, 40.0),)


@pytest.mark.parametrize(("make", "sentence"), [
    (lambda: Stack([Film(1.5, 100.0)], Lambert(0.5)), r"layers\[0\].kind = 'film': must lie on an interface or on"),
    (lambda: Stack([Film(1.5, 100.0), Medium(0.5, 1.0)]), r"layers\[0\].kind = 'film': must lie on an interface"),
    (lambda: Stack([Film(1.5, 100.0)]), "must lie on an interface or on a conductor, not on nothing"),
    (lambda: Stack([Film(1.5, 100.0), Interface(1.0, 0.1)]), r"layers\[1\].alpha = 0.1: must be 0 below a film"),
    (lambda: Stack([Film(1.5, 1e4), Interface(1.5)]), r"layers\[0\].thickness = 10000: must lie in \[0, 5000\] nm"),
    (lambda: Stack([Film(0.0, 10.0), Interface(1.5)]), r"layers\[0\].ior = 0: must lie in"),
    (lambda: Stack([Film(1.5, 10.0, k=[0.1, 0.2]), Interface(1.5)]), "have 2 channels and thin films"),
    (lambda: Stack([Film(1.5, 10.0), Interface([1.5, 1.4])], wavelengths=NM), "wavelengths has 3 entries: must have 2"),
    (lambda: Stack([Film(Spectrum([500, 400], [1.5, 1.4]), 10.0), Interface(1.5)]), "must be ascending numbers"),
    (lambda: Stack([Interface(1.5)], wavelengths=[5.0]), r"wavelengths\[0\] = 5: must lie in"),
    (lambda: Stack([Film(Spectrum(5, 7), 10.0), Interface(1.5)]), "ior.wavelengths = 5: must be a list"),
    (lambda: Stack([Film(["x", 1j], 10.0), Interface(1.5)]), r"layers\[0\].ior\[0\] = 'x': must be a number"),
    (lambda: Stack([Film(1.5, Spectrum([400, 700], [10, 20])), Interface(1.5)]), r"layers\[0\].thickness = Spectrum"),
    (lambda: Film(1.5 + 0.1j, 10.0, k=0.1), "film.k = 0.1: must be left out beside a complex ior"),
    (lambda: lamina.searchlight(Stack([Film(1.4, 10.0), Interface(1.5),
                                       Medium(sigma_s=1.0, sigma_a=0.1, thickness=1.0)], Lambert(0.5))),
     r"layers\[0\].kind = 'film': must be left out where light moves"),
])
def test_refusals(make, sentence):
    with pytest.raises(StackError, match=sentence):
        make()

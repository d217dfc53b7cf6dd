# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad stacks in Python get one sentence: the field, its value, the allowed range."""

import math

import numpy as np
import pytest

import lamina
from lamina import Black, HalfSpace, HenyeyGreenstein, Interface, Isotropic, Lambert, Medium, Stack, Tabulated

GOOD = Medium(albedo=0.9, tau=1.0)


def medium(**changes):
    return Stack([GOOD, Medium(**{"albedo": 0.9, "tau": 1.0, **changes})])


def hg(g):
    return medium(phase=HenyeyGreenstein(g))


BAD = {
    "albedo above 1": (lambda: medium(albedo=1.5), "layers[1].albedo = 1.5: must lie in [0, 1]"),
    "albedo negative": (lambda: medium(albedo=-0.1), "layers[1].albedo = -0.1: must lie in [0, 1]"),
    "albedo NaN": (lambda: medium(albedo=math.nan), "layers[1].albedo = nan: must lie in [0, 1]"),
    "albedo infinite": (lambda: medium(albedo=math.inf), "layers[1].albedo = inf: must lie in [0, 1]"),
    "albedo barely above 1": (lambda: medium(albedo=1.0000001), "layers[1].albedo = 1.0000001: must lie in [0, 1]"),
    "albedo of a channel": (lambda: medium(albedo=[0.5, 2.0, 0.5]), "layers[1].albedo[1] = 2: must lie in [0, 1]"),
    "albedo a text": (lambda: medium(albedo="x"), "layers[1].albedo = 'x': must be a number or one number per channel"),
    "albedo a truth": (
        lambda: medium(albedo=True), "layers[1].albedo = True: must be a number or one number per channel"),
    "albedo no channels": (lambda: medium(albedo=[]), "layers[1].albedo = []: must hold one number per channel"),
    "albedo a list of texts": (lambda: medium(albedo=["x"]), "layers[1].albedo[0] = 'x': must be a number"),
    "albedo a table": (lambda: medium(albedo=np.ones((2, 2))), "layers[1].albedo[0] = [1.0, 1.0]: must be a number"),
    "tau negative": (lambda: medium(tau=-1.0), "layers[1].tau = -1: must lie in [0, infinity]"),
    "tau NaN": (lambda: medium(tau=math.nan), "layers[1].tau = nan: must lie in [0, infinity]"),
    "tau minus infinity": (lambda: medium(tau=-math.inf), "layers[1].tau = -inf: must lie in [0, infinity]"),
    "g of 1": (lambda: hg(1.0), "layers[1].phase.g = 1: must lie in [-0.964, 0.964]"),
    "g of -1": (lambda: hg(-1.0), "layers[1].phase.g = -1: must lie in [-0.964, 0.964]"),
    "g too sharp to solve": (lambda: hg(0.99), "layers[1].phase.g = 0.99: must lie in [-0.964, 0.964]"),
    "g above": (lambda: hg(1.2), "layers[1].phase.g = 1.2: must lie in [-0.964, 0.964]"),
    "g NaN": (lambda: hg(math.nan), "layers[1].phase.g = nan: must lie in [-0.964, 0.964]"),
    "phase a text": (lambda: medium(phase="hg"), "layers[1].phase = 'hg': must be a phase function"),
    "sigma_s negative": (
        lambda: Stack([Medium(sigma_s=-1.0, sigma_a=1.0, thickness=1.0)]),
        "layers[0].sigma_s = -1: must lie in [0, 1e12] 1/mm"),
    "sigma_a infinite": (
        lambda: Stack([Medium(sigma_s=1.0, sigma_a=math.inf, thickness=1.0)]),
        "layers[0].sigma_a = inf: must lie in [0, 1e12] 1/mm"),
    "thickness negative": (
        lambda: Stack([Medium(sigma_s=1.0, sigma_a=1.0, thickness=-2.0)]),
        "layers[0].thickness = -2: must lie in [0, infinity] mm"),
    "two forms": (
        lambda: medium(sigma_s=1.0),
        "layers[1] has two forms: must have either albedo, tau or sigma_s, sigma_a, thickness or color, tau or "
        "pigment, amount, sigma_s, thickness"),
    "no coefficients": (
        lambda: Stack([Medium()]),
        "layers[0] has no coefficients: must have either albedo, tau or sigma_s, sigma_a, thickness or color, tau or "
        "pigment, amount, sigma_s, thickness"),
    "tau missing": (
        lambda: Stack([Medium(albedo=0.5)]),
        "layers[0].tau is missing: must have either albedo, tau or sigma_s, sigma_a, thickness or color, tau or "
        "pigment, amount, sigma_s, thickness"),
    "name a number": (lambda: medium(name=5), "layers[1].name = 5: must be a text"),
    "varying a number": (lambda: medium(varying=1), "layers[1].varying = 1: must be true or false"),
    "too many layers": (lambda: Stack([GOOD] * 65), "layers has 65 entries: a stack must have at most 64"),
    "empty": (lambda: Stack([]), "layers = []: a stack must hold at least one layer or a base"),
    "base in the middle": (
        lambda: Stack([Lambert(0.5), GOOD]), "layers[0].kind = 'lambert': a base can only stand at the bottom"),
    "two bases": (
        lambda: Stack([GOOD, Black()], base=Black()), "layers[1].kind = 'black': a base can only stand at the bottom"),
    "base no base": (lambda: Stack([GOOD], base=0.5), "base = 0.5: must be a base or none"),
    "base a class": (
        lambda: Stack([GOOD], Lambert), "base = <class 'lamina.kinds.bases.Lambert'>: must be a base or none"),
    "layer a class": (
        lambda: Stack([Interface]), "layers[0] = <class 'lamina.kinds.boundaries.Interface'>: must be a layer"),
    "phase a class": (
        lambda: medium(phase=HenyeyGreenstein),
        "layers[1].phase = <class 'lamina.kinds.phases.HenyeyGreenstein'>: must be a phase function"),
    "layer no layer": (lambda: Stack([GOOD, 7]), "layers[1] = 7: must be a layer"),
    "reflectance above 1": (
        lambda: Stack([GOOD], base=Lambert(1.1)), "base.reflectance = 1.1: must lie in [0, 1]"),
    "half-space g": (
        lambda: Stack(base=HalfSpace(0.5, HenyeyGreenstein(-2.0))), "base.phase.g = -2: must lie in [-0.964, 0.964]"),
    "two varying": (
        lambda: Stack([Medium(albedo=0.5, tau=1.0, varying=True)] * 2),
        "layers[1].varying = true: only one medium may vary"),
    "varying without end": (
        lambda: Stack([Medium(albedo=0.5, tau=math.inf, varying=True)]),
        "layers[0].tau = inf: a varying layer needs a largest thickness"),
    "channels disagree": (
        lambda: medium(albedo=[0.5, 0.5, 0.5], tau=[1.0, 2.0]),
        "layers[1].tau has 2 channels: must have 3 like layers[1].albedo"),
    "channels disagree with the base": (
        lambda: Stack([Medium(albedo=[0.5, 0.5], tau=1.0)], base=Lambert([0.1, 0.2, 0.3])),
        "base.reflectance has 3 channels: must have 2 like layers[0].albedo"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_stack(name):
    make, sentence = BAD[name]
    with pytest.raises(lamina.StackError) as caught:
        make()
    assert str(caught.value) == sentence


@pytest.mark.parametrize("stack", [
    Stack([Medium(albedo=0, tau=0)]),
    Stack([Medium(albedo=1, tau=math.inf)]),
    Stack([Medium(albedo=np.float32(0.5), tau=np.array([1.0, 2.0]), phase=HenyeyGreenstein(-0.964))]),
    Stack([Medium(sigma_s=0, sigma_a=0, thickness="inf")]),
    Stack(base=Black()),
    Stack([GOOD, Lambert(0.5)]),
], ids=["nothing", "endless", "numpy", "vacuum", "bare", "base as the last layer"])
def test_extreme_but_good_stacks(stack):
    assert stack.hash


@pytest.fixture(scope="module")
def solved():
    return lamina.solve(Stack([GOOD]))


@pytest.mark.parametrize("arguments, sentence", [
    ((0.0, 0.5, 0.0), "mu_o = 0: must lie in (0, 1]"),
    ((0.5, 1.5, 0.0), "mu_i = 1.5: must lie in (0, 1]"),
    ((0.5, [0.5, -0.2], 0.0), "mu_i = -0.2: must lie in (0, 1]"),
    ((math.nan, 0.5, 0.0), "mu_o holds a value that is not finite"),
    ((0.5, 0.5, math.inf), "dphi holds a value that is not finite"),
])
def test_bad_directions(solved, arguments, sentence):
    for look in (solved.brdf, solved.btdf):
        with pytest.raises(ValueError) as caught:
            look(*arguments)
        assert str(caught.value) == sentence


def test_bad_choices(solved):
    for call in (lambda: solved.brdf(0.5, 0.5, 0.0, side="left"), lambda: solved.reflectance(0.5, "left")):
        with pytest.raises(ValueError, match=r"^side = 'left': must be 'top' or 'bottom'$"):
            call()
    for call in (lambda: lamina.solve(Stack([GOOD]), "best"), lambda: lamina.bake(Stack([GOOD]), "best")):
        with pytest.raises(ValueError, match=r"^quality = 'best': must be one of preview, final$"):
            call()
    with pytest.raises(ValueError, match=r"^mu0 = 'all': must be a cosine in \(0, 1\] or 'diffuse'$"):
        solved.reflectance("all")
    with pytest.raises(ValueError, match=r"^path = 'scatter': must be"):
        solved.grid("scatter", 0.5, 0.5, 0.0)
    with pytest.raises(ValueError, match=r"^threads = -1: must be"):
        lamina.solve(Stack([GOOD]), threads=-1)
    with pytest.raises(ValueError, match=r"^channels = 2: must be 1 or 3 \(R G B\) for a lookup table$"):
        lamina.bake(Stack([Medium(albedo=[0.5, 0.6], tau=1.0)]))


def test_what_cannot_be_resolved_is_refused_with_numbers():
    """A table sharper than Henyey-Greenstein's function may be."""
    peak = Tabulated(moments=[0.98**k for k in range(1000)])
    with pytest.raises(lamina.SolveError, match=r"cannot be resolved: .* its moment 320 is [\d.e-]+, must be below"):
        lamina.solve(Stack([Medium(albedo=1.0, tau=1.0, phase=peak)]))
    assert issubclass(lamina.SolveError, RuntimeError) and Isotropic().kind == "isotropic"

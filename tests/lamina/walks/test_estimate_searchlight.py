# SPDX-License-Identifier: GPL-3.0-or-later
"""The walks with positions against exact values, against the solver's fluxes, and against each other: Z-scores with
fixed seeds, each family at a level of 1 %."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from half_space_3d import mean_square_distance, reflected_at
from searchlight_stacks import BOTH, CASES, FROSTED, GRADED, SLAB, VARNISHED, medium
from z_limit import z_limit

import lamina
from lamina import HalfSpace, Interface, Knot, Lambert, Medium, Stack

SAMPLES = 1 << 18
REFERENCE = {case["id"]: case for case in json.loads(
    (Path(__file__).parents[2] / "data/searchlight.json").read_text(encoding="utf-8"))["cases"]}


def scores(measured, truth, known_to=0.0):
    """Z-scores, flat; `known_to`: relative error of the true values."""
    truth = np.broadcast_to(np.asarray(truth, dtype=float), np.shape(measured.value))
    return np.ravel((measured.value - truth) / np.hypot(measured.stderr, known_to * truth + 1e-12)).tolist()


def between(one, other):
    """Z-scores of two independent estimates."""
    return np.ravel((one.value - other.value) / np.hypot(np.hypot(one.stderr, other.stderr), 1e-12)).tolist()


def check(found):
    assert all(abs(z) < z_limit(len(found)) for z in found), found


def half_space(albedo, scale=1.0):
    return Stack(base=HalfSpace(sigma_s=albedo / scale, sigma_a=(1.0 - albedo) / scale))


@pytest.mark.parametrize("walk", BOTH)
@pytest.mark.parametrize("case", [REFERENCE["half-space-a.9"], REFERENCE["half-space-a.5"]], ids=lambda c: c["id"])
def test_exact_half_spaces(walk, case):
    found = lamina.estimate_searchlight(half_space(case["albedo"]), samples=SAMPLES, seed=1, walk=walk, r=case["r"],
                                        q=case.get("q", []))
    family = scores(found.reflectance, case["R"]) + scores(found.reflected_inside, case["R_inside"], 1e-5)
    family += scores(found.reflected_at, case.get("R_at_frequency", []))
    family += scores(found.mean_distance, case["mean_r"], 1e-6)
    family += scores(found.mean_square_distance, case["mean_r2"], 1e-6)
    check(family)
    assert found.transmittance.value == found.mirrored.value == found.unscattered.value == 0.0


@pytest.mark.parametrize("walk", BOTH)
def test_further_albedos(walk):
    """At another scale of lengths: frequencies fall as lengths grow."""
    family = []
    for seed, albedo in enumerate((0.2, 0.7, 0.8, 0.97)):
        found = lamina.estimate_searchlight(half_space(albedo, 5.0), samples=SAMPLES, seed=seed, walk=walk,
                                            q=[0.06, 0.2, 0.6])
        family += scores(found.reflected_at, [reflected_at(q, albedo) for q in (0.3, 1.0, 3.0)])
        family += scores(found.mean_square_distance, 25.0 * mean_square_distance(albedo), 1e-5)
    check(family)


def test_a_conservative_half_space_returns_light_from_any_depth():
    """At low frequencies light from below the walk's depth counts; the mean distance is infinite."""
    q = [0.005, 0.02, 0.1, 0.5]
    found = lamina.estimate_searchlight(half_space(1.0), samples=1 << 17, seed=2, q=q)
    check(scores(found.reflected_at, [reflected_at(one, 1.0) for one in q]) + scores(found.reflectance, 1.0))
    assert found.mean_distance.value == found.mean_square_distance.value == math.inf


def test_the_reference_slab():
    """Discrete ordinates with coupled azimuth orders, good to about 1e-6."""
    case = REFERENCE["slab"]
    found = lamina.estimate_searchlight(SLAB, samples=1 << 19, seed=3, q=case["q"])
    family = scores(found.reflectance, case["R"], 1e-5) + scores(found.transmittance, case["T"], 1e-5)
    family += scores(found.reflected_at, case["R_at_frequency"], 2e-5)
    family += scores(found.transmitted_at, case["T_at_frequency"], 2e-5)
    family += scores(found.mean_square_distance, case["mean_r2_R"], 2e-5)
    check(family)
    assert found.unscattered.value == pytest.approx(math.exp(-2.0), rel=1e-12)


FREQUENCIES = sum(2 * len(case.walks) * len(case.q) * case.stack.channels for case in CASES)
ALL_CASES = [(case.name, case.stack, walk) for case in CASES for walk in case.walks]


@pytest.mark.parametrize("mu_i", [1.0, 0.4])
def test_fluxes_are_the_solvers(mu_i):
    family = []
    for seed, (_, stack, walk) in enumerate(ALL_CASES):
        solved = lamina.solve(stack, threads=1)
        found = lamina.estimate_searchlight(stack, mu_i, 1 << 16, seed, walk=walk)
        whole, mirrored = solved.reflectance(mu_i), solved.reflectance(mu_i, parts=True)[1]
        family += scores(found.reflectance, whole if stack.channels > 1 else whole[0], 2e-5)
        assert np.atleast_1d(found.mirrored.value) == pytest.approx(mirrored, abs=1e-9)
        if stack.base is None:
            through, direct = solved.transmittance(mu_i), solved.transmittance(mu_i, parts=True)[1]
            family += scores(found.transmittance, through[0], 2e-5)
            assert np.atleast_1d(found.unscattered.value) == pytest.approx(direct, abs=1e-9)
        else:
            assert np.all(found.transmittance.value == 0.0)
    check(family)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_walk_finds_the_deterministic_searchlight(case):
    """At five lateral frequencies, both sides, all channels; one family over all stacks."""
    # A final solve of a graded medium takes minutes. The solver's errors are below these shares of the beam's flux.
    quality, promised = ("preview", 1e-4) if case.name == "graded" else ("final", 1e-5)
    beam = lamina.searchlight(case.stack, quality=quality, threads=1)
    for walk in case.walks:
        found = lamina.estimate_searchlight(case.stack, samples=SAMPLES, seed=11, walk=walk, q=case.q)
        for name in ("reflected_at", "transmitted_at"):
            truth = getattr(beam, name)(case.q)
            measured = getattr(found, name)
            z = (measured.value - truth) / np.hypot(measured.stderr, promised)
            assert np.all(np.abs(z) < z_limit(FREQUENCIES)), (walk, name, z)
        # Light of a rough surface that leaves at once, at the beam's own place, counts as specular in the solver.
        if case.stack != FROSTED:
            assert found.mirrored.value == pytest.approx(beam.mirrored, abs=1e-6)
        assert found.unscattered.value == pytest.approx(beam.unscattered, abs=1e-6)


@pytest.mark.parametrize("mu_i", [1.0, 0.5])
def test_both_walks_agree(mu_i):
    family = []
    for seed, case in enumerate(case for case in CASES if case.walks == BOTH):
        transfer, scattering = (
            lamina.estimate_searchlight(case.stack, mu_i, SAMPLES, seed, walk=walk, r=[0.3, 1.0, 4.0], q=case.q)
            for walk in BOTH)
        for name in ("reflectance", "transmittance", "reflected_inside", "transmitted_inside", "reflected_at",
                     "transmitted_at", "mean_distance"):
            family += between(getattr(transfer, name), getattr(scattering, name))
    check(family)


@pytest.mark.parametrize("mu_i", [1.0, 0.6])
def test_a_clear_gap_over_a_lambert_surface(mu_i):
    """The beam is displaced on its way down; a Lambert surface sends light up with the transform
    int 2 mu J0(q d tan) dmu = q d K1(q d)."""
    thickness, q = 0.7, np.array([0.5, 2.0, 4.0])
    stack = Stack([Medium(sigma_s=0.0, sigma_a=0.0, thickness=thickness)], Lambert(0.8))
    t = (np.arange(20000) + 0.5) / 20000
    bessel = np.array([float(np.mean(_j0(x * np.sqrt(1.0 / t**2 - 1.0)) * 2.0 * t)) for x in q * thickness])
    shift = thickness * math.sqrt(1.0 / mu_i**2 - 1.0)
    found = lamina.estimate_searchlight(stack, mu_i, SAMPLES, 5, q=q)
    check(scores(found.reflected_at, 0.8 * bessel * _j0(q * shift), 1e-5) + scores(found.reflectance, 0.8))


def _j0(x):
    """The integral (1/pi) int cos(x sin t) dt by the trapezoidal rule, exact to rounding for moderate x."""
    t = (np.arange(400) + 0.5) * math.pi / 400
    return np.cos(np.multiply.outer(x, np.sin(t))).mean(axis=-1)


def test_unscattered_light_of_an_oblique_beam_keeps_its_place():
    """A clear plate of glass, and a layer that only absorbs: all paths of light in closed form."""
    mu_i, thickness, n, q = 0.5, 2.0, 1.5, np.array([0.3, 1.0, 3.0])
    plate = Stack([Interface(n), Medium(sigma_s=0.0, sigma_a=0.1, thickness=thickness), Interface(1.0)])
    inner = math.sqrt(1.0 - (1.0 - mu_i**2) / n**2)
    back = 0.5 * (((mu_i - n * inner) / (mu_i + n * inner)) ** 2 + ((n * mu_i - inner) / (n * mu_i + inner)) ** 2)
    shift, kept = thickness * math.sqrt(1.0 / inner**2 - 1.0), math.exp(-0.1 * thickness / inner)
    mirrored = back + sum((1 - back) ** 2 * back ** (2 * k - 1) * kept ** (2 * k) * _j0(2 * k * q * shift)
                          for k in range(1, 30))
    through = sum((1 - back) ** 2 * back ** (2 * k) * kept ** (2 * k + 1) * _j0((2 * k + 1) * q * shift)
                  for k in range(30))
    found = lamina.estimate_searchlight(plate, mu_i, SAMPLES, 6, q=q)
    check(scores(found.reflected_at, mirrored) + scores(found.transmitted_at, through))
    assert found.reflectance.stderr == found.transmittance.stderr == 0.0
    for walk in BOTH:
        dark = lamina.estimate_searchlight(Stack([Medium(sigma_s=0.0, sigma_a=0.5, thickness=1.0)]), mu_i, 1, walk=walk,
                                           q=q, r=[1.7, 1.8])
        assert dark.transmitted_at.value == pytest.approx(math.exp(-1.0) * _j0(q * math.sqrt(3.0)), rel=1e-9)
        assert np.all(dark.transmitted_at.stderr == 0.0)
        assert dark.transmitted_inside.value == pytest.approx([0.0, math.exp(-1.0)], rel=1e-12)


@pytest.mark.parametrize("walk", BOTH)
def test_a_jump_in_a_profile_is_two_layers(walk):
    knots = [Knot(0.0, sigma_s=1.0, sigma_a=0.1), Knot(0.4, sigma_s=1.0, sigma_a=0.1),
             Knot(0.4, sigma_s=3.0, sigma_a=0.0), Knot(1.0, sigma_s=3.0, sigma_a=0.0)]
    profile = Stack([Medium(thickness=1.0, profile=knots)])
    layers = Stack([medium(1.0, 0.1, 0.4), medium(3.0, 0.0, 0.6)])
    one, other = (lamina.estimate_searchlight(stack, 0.7, SAMPLES, seed, walk=walk, r=[0.2, 0.5], q=[1.0, 4.0])
                  for seed, stack in enumerate((profile, layers)))
    check([z for name in ("reflected_inside", "transmitted_inside", "reflected_at", "transmitted_at", "mean_distance")
           for z in between(getattr(one, name), getattr(other, name))])


@pytest.mark.parametrize("walk", BOTH)
def test_a_ramp_of_coefficients_is_many_thin_layers(walk):
    """From nothing to dense, where lengths depend most on the depth."""
    count = 60
    ramp = Stack([Medium(thickness=2.0, profile=[Knot(0.0, sigma_s=0.0, sigma_a=0.0),
                                                 Knot(1.0, sigma_s=3.0, sigma_a=0.1)])])
    steps = Stack([medium(3.0 * (k + 0.5) / count, 0.1 * (k + 0.5) / count, 2.0 / count) for k in range(count)])
    one, other = (lamina.estimate_searchlight(stack, 1.0, 1 << 17, seed, walk=walk, r=[0.5, 1.5], q=[0.5, 2.0])
                  for seed, stack in enumerate((ramp, steps)))
    check([z for name in ("reflected_inside", "transmitted_inside", "reflected_at", "transmitted_at", "mean_distance")
           for z in between(getattr(one, name), getattr(other, name))])


def test_standard_errors_and_covariances_are_honest():
    """Over 60 seeds, the spread agrees with the standard errors of the estimates."""
    found = [lamina.estimate_searchlight(VARNISHED, samples=4096, seed=seed, threads=1, r=[0.3, 1.0], q=[1.0, 3.0])
             for seed in range(60)]
    for name in ("reflectance", "reflected_inside", "reflected_at", "mean_distance", "mean_square_distance"):
        values = np.array([np.atleast_1d(getattr(f, name).value) for f in found])
        errors = np.array([np.atleast_1d(getattr(f, name).stderr) for f in found])
        # The standard deviation of a sample of 60 is off by 9 %.
        assert np.all(np.abs(values.std(axis=0, ddof=1) / errors.mean(axis=0) - 1.0) < 0.4), name
    vectors = np.array([np.append(f.reflectance.value, f.reflected_at.value) for f in found])
    said = np.mean([f.reflected_covariance for f in found], axis=0)
    assert said.shape == (3, 3)
    seen = np.corrcoef(vectors.T)
    # Correlations of 60 pairs are known to .13.
    assert np.all(np.abs(said / np.sqrt(np.outer(np.diag(said), np.diag(said))) - seen) < 0.4)
    assert said[1, 2] > 0.0 and np.allclose(np.sqrt(np.diag(said))[1:], np.mean([f.reflected_at.stderr for f in found],
                                                                              axis=0), rtol=0.01)


def same(one, other):
    for name in ("reflectance", "transmittance", "reflected_inside", "transmitted_inside", "reflected_at",
                 "transmitted_at", "mean_distance", "mean_square_distance"):
        for part in ("value", "stderr"):
            assert getattr(getattr(one, name), part).tobytes() == getattr(getattr(other, name), part).tobytes()
    for name in ("reflected_covariance", "transmitted_covariance", "samples", "events"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()


@pytest.mark.parametrize("walk", BOTH)
def test_same_bytes_for_any_threads(walk):
    one, two = (lamina.estimate_searchlight(GRADED, 0.6, 40000, 7, threads, walk, r=[0.5, 2.0], q=[1.0])
                for threads in (1, 2))
    same(one, two)
    assert one.samples.tolist() == [40960]


def test_shapes_and_sequence():
    """Channels come last; radii and frequencies keep the given sequence."""
    stack = Stack([medium((1.0, 2.0, 2.0), (0.1, 0.1, 0.1), 1.0)])
    found = lamina.estimate_searchlight(stack, samples=8192, threads=1, r=[2.0, 0.5, 2.0], q=3.0)
    assert found.reflected_inside.value.shape == (3, 3) and found.transmitted_at.stderr.shape == (1, 3)
    assert found.reflectance.value.shape == (3,) and found.transmitted_covariance.shape == (2, 2, 3)
    assert np.array_equal(found.reflected_inside.value[0], found.reflected_inside.value[2])
    assert np.all(found.reflected_inside.value[1] < found.reflected_inside.value[0])
    assert np.array_equal(found.reflected_at.value[:, 1], found.reflected_at.value[:, 2])  # one problem, one run
    none = lamina.estimate_searchlight(SLAB, samples=1, threads=1)
    assert none.reflected_inside.value.shape == none.reflected_at.value.shape == (0,)


def test_progress_and_cancel():
    told = []
    lamina.estimate_searchlight(SLAB, samples=200000, threads=1, progress=lambda fraction, text: told.append(fraction))
    assert told == sorted(told) and told[0] == 0.0 and told[-1] == 1.0 and len(told) == 5
    with pytest.raises(lamina.Cancelled):
        lamina.estimate_searchlight(SLAB, samples=1 << 30, threads=1, cancel=lambda: True)


BAD = [
    ({"stack": Stack([Medium(albedo=0.9, tau=1.0)])}, "layers[0]: has no lengths, must have sigma_s"),
    ({"stack": Stack(base=HalfSpace(0.9))}, "base: has no lengths, must have sigma_s and sigma_a"),
    ({"stack": {}}, "stack = {}: must be a lamina.Stack"),
    ({"mu_i": 0.0}, "mu_i = 0.0: must be one number in (0, 1]"),
    ({"walk": "guess"}, "walk = 'guess': must be one of transfer, scattering"),
    ({"samples": 0}, "samples = 0: must be a whole number"),
    ({"seed": -1}, "seed = -1"),
    ({"threads": -1}, "threads = -1"),
    ({"r": [1.0, -2.0]}, "r = -2: must be at least 0 mm"),
    ({"r": [math.nan]}, "r holds a value that is not finite"),
    ({"r": "wide"}, "r = 'wide': must be a number or an array of numbers"),
    ({"q": -1.0}, "q = -1: must be at least 0 1/mm"),
    ({"q": np.ones(65)}, "q has 65 values: must be at most 64"),
    ({"stack": VARNISHED, "walk": "scattering"}, "walk = 'scattering': "),
    ({"stack": half_space(1.0), "walk": "scattering"}, "walk = 'scattering': "),
    ({"progress": 3}, "progress = 3: must be a function or None"),
]


@pytest.mark.parametrize(("arguments", "sentence"), BAD)
def test_bad_input_gets_one_sentence(arguments, sentence):
    with pytest.raises(ValueError) as refused:
        lamina.estimate_searchlight(**{"stack": SLAB, "samples": 1, **arguments})
    assert str(refused.value).startswith(sentence) and "\n" not in str(refused.value)


def test_mean_distances_of_the_searchlight():
    """Mean distance and mean square of reflected light, for scattering that is not isotropic, oblique beams, layers and
    boundaries. Both qualities are compared with the same walks."""
    forward = lamina.HenyeyGreenstein(0.8)
    stacks = [Stack(base=HalfSpace(sigma_s=0.9, sigma_a=0.1, phase=lamina.HenyeyGreenstein(0.3))),
              Stack(base=HalfSpace(sigma_s=4.0, sigma_a=0.2, phase=forward)),
              Stack([Interface(1.4), Medium(sigma_s=2.0, sigma_a=0.3, thickness=1.5, phase=forward)],
                    HalfSpace(sigma_s=1.0, sigma_a=0.2)),
              *(Stack([Interface(1.46, alpha)], HalfSpace(sigma_s=13.0, sigma_a=0.1)) for alpha in (0.05, 0.3))]
    family = {"final": [], "preview": []}
    for seed, stack in enumerate(stacks):
        for mu in (1.0, 0.5):
            found = lamina.estimate_searchlight(stack, mu, samples=4 * SAMPLES, seed=seed)
            for quality, found_by in family.items():
                beam = lamina.searchlight(stack, mu, quality)
                found_by += scores(found.mean_distance, beam.mean_distance)
                found_by += scores(found.mean_square_distance, beam.mean_square_distance)
    for found_by in family.values():
        check(found_by)


def test_the_spectrum_has_no_step_at_frequency_0():
    """Lobes of rough boundaries have orders that few azimuths do not keep apart."""
    for alpha in (0.05, 0.2, 0.6):
        for mu in (1.0, 0.25):
            beam = lamina.searchlight(Stack([Interface(1.46, alpha)], HalfSpace(sigma_s=13.0, sigma_a=0.1)), mu)
            # Without a step, this is q^2 / 4 times the mean square distance, which is far below 1.2 mm^2.
            lost = beam.reflectance - beam.reflected_at([0.01, 0.02])
            assert np.all(lost < 0.3 * beam.reflectance * np.array([0.01, 0.02]) ** 2 + 2e-6)
            assert beam.reflected_inside(200.0) == pytest.approx(beam.reflectance[0], abs=5e-5)


@pytest.mark.parametrize("alpha", [0.1, 0.5])
def test_a_rough_boundary_loses_nothing(alpha):
    """Over a white base all light leaves, in each walk: no error but rounding."""
    found = lamina.estimate_searchlight(Stack([Interface(1.5, alpha)], Lambert(1.0)), 0.3, samples=1 << 14)
    assert found.reflectance.value == pytest.approx(1.0, abs=1e-9)


LATE = {
    "lobes through a thin slab": (Stack([Interface(1.5, 0.6), Medium(sigma_s=0.4, sigma_a=0.01, thickness=0.5),
                                         Interface(1.0)]), (1.0, 0.5), (4.0, 12.0, 40.0)),
    "lobes on both faces": (Stack([Interface(1.5, 0.3), Medium(sigma_s=5.0, sigma_a=0.5, thickness=0.3),
                                   Interface(1.0, 0.3)]), (1.0, 0.5), (1.0, 13.0, 40.0)),
    "a beam that leaves far away": (Stack([Medium(sigma_s=0.24, sigma_a=0.33, thickness=1.1),
                                           Medium(sigma_s=4.8, sigma_a=9.2, thickness=0.014)]), (0.5,),
                                    (1.5, 4.0, 12.0)),
}


@pytest.mark.parametrize("name", LATE)
def test_spectra_that_fall_late_or_oscillate(name):
    """Lobes of boundaries keep light near the beam, and an oblique beam leaves far from its entry."""
    stack, cosines, q = LATE[name]
    family = []
    for mu in cosines:
        beam = lamina.searchlight(stack, mu)
        found = lamina.estimate_searchlight(stack, mu, samples=2 * SAMPLES, seed=4, q=q)
        for measured, value in ((found.reflected_at, beam.reflected_at(q)),
                                (found.transmitted_at, beam.transmitted_at(q))):
            # The solver is good to 3e-4 of the flux there.
            family += ((np.ravel(measured.value) - value) / np.hypot(np.ravel(measured.stderr), 3e-4)).tolist()
    check(family)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D scattering function against exact half-spaces, published slabs, the 1D solver, and its own reciprocity."""

import functools
import json
import math
from pathlib import Path

import half_space_3d
import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, HalfSpace, HenyeyGreenstein, Interface, Lambert, Medium, Stack, _core
from lamina.lateral.measured import measured_layers, measured_stack
from lamina.solver.core_calls import thread_pool

REFERENCE = json.loads((Path(__file__).parents[2] / "data/searchlight.json").read_text(encoding="utf-8"))["cases"]


def medium(albedo, thickness, g=0.0, sigma_t=1.0):
    scattered = np.asarray(albedo) * sigma_t
    return Medium(sigma_s=scattered, sigma_a=sigma_t - scattered, thickness=thickness, phase=HenyeyGreenstein(g))


def half_space(albedo, sigma_t=1.0, g=0.0):
    return Stack([], HalfSpace(sigma_s=albedo * sigma_t, sigma_a=(1.0 - albedo) * sigma_t, phase=HenyeyGreenstein(g)))


@functools.cache
def solved_half_space(albedo, sigma_t=1.0):
    return lamina.searchlight(half_space(albedo, sigma_t))


@pytest.mark.parametrize("case", [c for c in REFERENCE if "R_inside" in c], ids=lambda c: c["id"])
def test_exact_half_spaces(case):
    beam = solved_half_space(case["albedo"])
    assert beam.reflectance[0] == pytest.approx(case["R"], abs=1e-6)
    assert np.allclose(beam.reflected_inside(case["r"]), case["R_inside"], atol=1e-5)
    if "q" in case:
        assert np.allclose(beam.reflected_at(case["q"]), case["R_at_frequency"], atol=2e-6)
    assert beam.mean_distance[0] == pytest.approx(case["mean_r"], rel=1e-5)
    assert beam.mean_square_distance[0] == pytest.approx(case["mean_r2"], rel=1e-5)


@pytest.mark.parametrize("albedo", [0.2, 0.99, 0.999])
def test_more_half_spaces_at_frequencies(albedo):
    beam = solved_half_space(albedo)
    q = np.array([0.02, 0.1, 0.5, 1.0, 2.0, 5.0, 12.0])
    exact = [half_space_3d.reflected_at(one, albedo) for one in q]
    # The tolerance is 1e-5; beyond the frequency 5 of a mean free path, twelve azimuths have errors of 4e-6.
    assert np.allclose(beam.reflected_at(q), exact, rtol=0.0, atol=1e-5)
    assert np.allclose(beam.reflected_at(q)[:-1], exact[:-1], rtol=0.0, atol=1e-6)


def test_profile_of_a_half_space():
    """The derivative of the flux inside, and near the beam the closed form of single scattering."""
    beam = solved_half_space(0.9)
    r = np.array([0.05, 0.3, 1.0, 3.0, 8.0])
    step = 1e-3 * r
    slope = (beam.reflected_inside(r + step) - beam.reflected_inside(r - step)) / (2.0 * step)
    assert np.allclose(beam.profile(r), slope / (2.0 * np.pi * r), rtol=1e-4)
    assert beam.profile(1e-4) * 1e-4 == pytest.approx(0.9 / (4.0 * np.pi), rel=2e-3)


def test_all_light_is_inside_a_far_radius():
    beam = solved_half_space(0.9, 2.0)
    assert np.allclose(beam.reflected_inside([1e2, 1e4, 1e6, 1e9]), beam.reflectance, atol=1e-8)


def test_far_from_the_beam():
    """A tail with a decay length of a millimetre is still accurate where 1e-7 of the flux is left."""
    beam = solved_half_space(0.5)
    far = np.linspace(8.0, 14.0, 13)
    fall = np.diff(np.log(beam.profile(far) * far**2.0)) / np.diff(far)
    assert np.all(fall < -0.8) and np.all(fall > -1.2)
    assert np.all(np.diff(beam.reflected_inside(far)) > 0.0)


def test_lengths_scale():
    near, far = solved_half_space(0.9), solved_half_space(0.9, 0.1)
    assert far.mean_distance == pytest.approx(10.0 * near.mean_distance, rel=1e-9)
    r = np.array([0.1, 1.0, 4.0])
    assert np.allclose(far.reflected_inside(10.0 * r), near.reflected_inside(r), atol=1e-9)


def test_published_slab():
    case = next(c for c in REFERENCE if c["id"] == "slab")
    beam = lamina.searchlight(Stack([medium(case["albedo"], case["tau"], case["g"])]))
    assert beam.reflectance[0] == pytest.approx(case["R"], abs=5e-6)
    assert beam.transmittance[0] == pytest.approx(case["T"], abs=5e-6)
    assert beam.unscattered[0] == pytest.approx(math.exp(-2.0), rel=1e-9) and beam.mirrored[0] == 0.0
    assert np.allclose(beam.reflected_at(case["q"]), case["R_at_frequency"], atol=1e-5)
    assert np.allclose(beam.transmitted_at(case["q"]), case["T_at_frequency"], atol=1e-5)
    assert beam.mean_square_distance[0] == pytest.approx(case["mean_r2_R"], rel=1e-3)
    assert beam.transmitted_inside(0.0) == pytest.approx(math.exp(-2.0), rel=1e-9)
    assert beam.transmitted_inside(1e3) == pytest.approx(beam.transmittance[0], abs=1e-5)


SKIN = medium([0.95, 0.9, 0.8], [0.3, 0.2, 0.1], 0.8, 8.0)
STACKS = {
    "conservative sheet": Stack([medium(1.0, 2.0, 0.5)]),
    "thin": Stack([medium(0.8, 0.02, 0.3)]),
    "absorbing over dense": Stack([medium(0.0, 0.4), medium(0.9, 1.5, 0.6, 3.0)], Lambert(0.5)),
    "two layers": Stack([medium(0.9, 0.5, 0.8, 2.0), medium(0.7, 3.0, 0.0, 0.5)]),
    "peaked": Stack([medium(0.98, 1.0, 0.93, 6.0)], Lambert(0.2)),
    "backward": Stack([medium(0.9, 1.0, -0.5)]),
    "colours over a half-space": Stack([SKIN], HalfSpace(sigma_s=2.0, sigma_a=[0.1, 0.5, 1.0])),
    "glass over a bright sheet": Stack([Interface(1.5), medium(0.95, 1.0, 0.3), Interface(1.0)]),
    "varnish": Stack([Interface(1.5), medium(0.3, 0.1), medium(0.97, 2.0, 0.6, 4.0)], Lambert(0.8)),
    "rough varnish": Stack([Interface(1.4, alpha=0.3), medium(0.97, 2.0, 0.6, 4.0)], Lambert(0.3)),
    "mirror": Stack([medium(0.9, 0.7, 0.2)], Conductor(eta=0.2, k=3.5)),
    "rough metal": Stack([medium(0.9, 0.3, 0.2)], Conductor(eta=0.2, k=3.5, alpha=0.3)),
}


@functools.cache
def preview(name):
    return lamina.searchlight(STACKS[name])


@pytest.mark.parametrize("name", STACKS)
def test_all_light_is_that_of_the_plane_solution(name):
    stack = STACKS[name]
    beam, plane = preview(name), lamina.solve(stack)
    assert np.allclose(beam.reflectance, plane.reflectance(1.0), atol=1e-5)
    assert np.allclose(beam.transmittance, plane.transmittance(1.0), atol=1e-5)
    assert np.allclose(beam.reflected_at(0.0), beam.reflectance, atol=1e-12)
    farthest = 400.0
    assert np.allclose(beam.reflected_inside(farthest), beam.reflectance, atol=1e-5)
    direct = plane.transmittance(1.0, parts=True)[1]
    assert np.allclose(beam.unscattered, direct, atol=1e-9)
    if name not in ("rough varnish", "rough metal"):
        assert np.allclose(beam.mirrored, plane.reflectance(1.0, parts=True)[1], atol=1e-9)


@pytest.mark.parametrize("quality", ["preview", "final"])
@pytest.mark.parametrize("g", [-0.3, 0.16, 0.28, 0.3, 0.42])
def test_faint_forward_peaks(g, quality):
    """Peaks of 1e-12 to 1e-9 of the light, which truncation leaves at these anisotropies."""
    stack = Stack([medium(0.995, 0.5, g, 20.0)])
    beam, plane = lamina.searchlight(stack, quality=quality), lamina.solve(stack)
    allowed = 1e-5 if quality == "final" else 1e-4
    assert np.allclose(beam.reflectance, plane.reflectance(1.0), atol=allowed)
    assert np.allclose(beam.transmittance, plane.transmittance(1.0), atol=allowed)
    assert 0.0 < beam.mean_distance[0] < 0.5 and beam.profile(0.1) > 0.0


@pytest.mark.parametrize("g", [0.2, 0.3, 0.4])
def test_slow_waves_below_a_dense_layer(g):
    """Azimuths of slow waves are exact enough that thick white layers do not amplify their errors: the spectrum has no
    step at frequency 0, and photons have the same mean square."""
    stack = Stack([medium(1.0, 0.5, g, 20.0)], HalfSpace(sigma_s=1.0, sigma_a=0.05))
    beam = lamina.searchlight(stack)
    slow = 1e-3
    square = 4.0 * (beam.reflectance - beam.reflected_at(slow)) / slow**2
    assert square == pytest.approx(beam.reflectance * beam.mean_square_distance, rel=1e-3)
    walk = lamina.estimate_searchlight(stack, samples=200_000, seed=2)
    for found, measured in ((beam.mean_distance, walk.mean_distance),
                            (beam.mean_square_distance, walk.mean_square_distance)):
        assert abs(found - measured.value) < z_limit(6) * measured.stderr


def test_flat_beams():
    """They count as beams of a cosine of 1e-4."""
    stack = Stack([medium(0.95, 1.0, 0.0, 2.0)])
    flat = lamina.searchlight(stack, mu_i=1e-12, quality="preview")
    assert flat.mu_i == 1e-4
    assert flat.reflectance == pytest.approx(lamina.solve(stack).reflectance(1e-4), abs=1e-4)
    walk = lamina.estimate_searchlight(stack, mu_i=1e-12, samples=100_000, seed=3)
    assert abs(walk.reflectance.value - flat.reflectance) < z_limit(1) * walk.reflectance.stderr + 1e-4


def test_transmission_upside_down():
    """By reciprocity, diffuse transmission through a sheet equals that through the reversed sheet, at every frequency:
    a test of beams at all angles together."""
    layers = [medium(0.9, 0.5, 0.7, 2.0), medium(0.7, 1.0, 0.0, 0.8)]
    x, weight = np.polynomial.legendre.leggauss(12)
    mu = 0.5 * (x + 1.0)
    pool = thread_pool(0)
    for q in (0.1, 0.3):
        sums = []
        for order in (layers, layers[::-1]):
            core = measured_stack(*measured_layers(Stack(order), 0, "final"))
            through = [_core.lateral_flux(core, float(m), q, 8, 8, 0.2, pool)[1] for m in mu]
            sums.append(np.sum(weight * mu * through))
        assert sums[0] == pytest.approx(sums[1], rel=1e-4)


def test_oblique_light_at_no_frequency():
    stack = STACKS["glass over a bright sheet"]
    beam, plane = lamina.searchlight(stack, mu_i=0.4), lamina.solve(stack)
    assert np.allclose(beam.reflectance, plane.reflectance(0.4), atol=1e-5)
    assert np.allclose(beam.transmittance, plane.transmittance(0.4), atol=1e-5)


def test_clear_layer_over_a_lambert_surface():
    """Light that a diffuse surface sends through a clear layer of thickness h: q h K1(q h) of it, in closed form; the
    mean distance is pi / 2 h, and the mean square is infinite."""
    thickness, q = 0.5, np.array([0.4, 2.0, 8.0])
    beam = lamina.searchlight(Stack([Medium(sigma_s=0.0, sigma_a=0.0, thickness=thickness)], Lambert(0.8)))
    t = np.linspace(0.0, 12.0, 4001)
    weight = np.where(t == 0.0, 0.5, 1.0) * (t[1] - t[0])
    exact = [0.8 * x * np.sum(weight * np.exp(-x * np.cosh(t)) * np.cosh(t)) for x in q * thickness]
    assert np.allclose(beam.reflected_at(q), exact, atol=1e-5)
    assert beam.reflectance[0] == pytest.approx(0.8, abs=1e-9)
    assert beam.mean_distance[0] == pytest.approx(0.25 * math.pi, rel=1e-2)
    assert beam.mean_square_distance[0] == math.inf


def test_graded_medium():
    """Linear coefficients against many homogeneous layers."""
    graded = Medium(thickness=1.0, phase=HenyeyGreenstein(0.5), profile=[
        lamina.Knot(0.0, sigma_s=4.0, sigma_a=0.5), lamina.Knot(1.0, sigma_s=1.0, sigma_a=0.1)])
    count = 24
    places = (np.arange(count) + 0.5) / count
    steps = [Medium(sigma_s=4.0 - 3.0 * z, sigma_a=0.5 - 0.4 * z, thickness=1.0 / count, phase=HenyeyGreenstein(0.5))
             for z in places]
    q = [0.0, 1.0, 4.0]
    own, many = (lamina.searchlight(stack, quality="preview") for stack in (Stack([graded]), Stack(steps)))
    # Two previews, each good to 1e-4, and the steps of the coefficients: measured 3.04e-4 at q = 4.
    assert np.allclose(own.reflected_at(q), many.reflected_at(q), rtol=0.0, atol=5e-4)
    assert np.allclose(own.transmitted_at(q), many.transmitted_at(q), rtol=0.0, atol=5e-4)
    plane = lamina.solve(Stack([graded]))
    assert own.reflectance == pytest.approx(plane.reflectance(1.0), abs=1e-4)


def test_same_bytes_for_any_thread_count():
    stack = STACKS["two layers"]
    one, three = (lamina.searchlight(stack, quality="preview", threads=t) for t in (1, 3))
    r = np.linspace(0.0, 3.0, 7)
    assert one.reflected_inside(r).tobytes() == three.reflected_inside(r).tobytes()
    assert one.mean_distance.tobytes() == three.mean_distance.tobytes()


def test_preview_is_near():
    stack = STACKS["varnish"]
    near, final = lamina.searchlight(stack, quality="preview"), preview("varnish")
    r = np.array([0.05, 0.2, 1.0])
    assert np.allclose(near.reflected_inside(r), final.reflected_inside(r), atol=2e-4)
    assert np.allclose(near.profile(r), final.profile(r), rtol=2e-2)


def test_progress_and_cancel():
    stack = STACKS["thin"]
    seen = []
    lamina.searchlight(stack, quality="preview", progress=lambda share, text: seen.append(share))
    assert seen == sorted(seen) and seen[0] < 0.2 and seen[-1] == 1.0
    with pytest.raises(lamina.Cancelled, match="searchlight"):
        lamina.searchlight(stack, cancel=lambda: True)


def test_endless_light_where_nothing_is_absorbed():
    beam = lamina.searchlight(half_space(1.0), quality="preview")
    assert beam.reflectance[0] == pytest.approx(1.0, abs=1e-6)
    assert beam.mean_distance[0] == math.inf and beam.mean_square_distance[0] == math.inf


@pytest.mark.parametrize("stack, words", [
    (Stack([Medium(albedo=0.9, tau=1.0)]), r"layers\[0\]: has no lengths, must have sigma_s and sigma_a"),
    (Stack([Interface(1.5), Medium(color=0.5, tau=1.0)]), r"layers\[1\]: has no lengths"),
    (Stack([], HalfSpace(0.9)), "base: has no lengths, must have sigma_s and sigma_a"),
    (Stack([Medium(sigma_s=0.0, sigma_a=0.0, thickness=math.inf)]), r"layers\[0\].thickness = inf"),
])
def test_media_without_lengths_are_refused(stack, words):
    with pytest.raises(lamina.StackError, match=words) as caught:
        lamina.searchlight(stack)
    assert str(caught.value).count(".") <= 3 and "\n" not in str(caught.value)


@pytest.mark.parametrize("call, words", [
    (lambda: lamina.searchlight(STACKS["thin"], mu_i=0.0), "mu_i = 0.0: must lie in"),
    (lambda: lamina.searchlight(STACKS["thin"], quality="best"), "quality = 'best'"),
    (lambda: lamina.searchlight(STACKS["thin"], threads=-1), "threads = -1"),
    (lambda: lamina.searchlight([]), "stack = "),
    (lambda: solved_half_space(0.9).profile(0.0), "r = 0: must be larger than 0"),
    (lambda: solved_half_space(0.9).reflected_at([-1.0]), "q = -1: must be at least 0"),
    (lambda: solved_half_space(0.9).reflected_inside([math.nan]), "r holds a value that is not finite"),
])
def test_bad_arguments(call, words):
    with pytest.raises(lamina.ArgumentError, match=words):
        call()


def test_half_space_with_lengths_is_the_same_stack():
    """The hash is that of the albedo, and JSON stores the lengths."""
    by_lengths = Stack([], HalfSpace(sigma_s=[3.0, 1.0], sigma_a=1.0))
    assert by_lengths.hash == Stack([], HalfSpace([0.75, 0.5])).hash
    again = Stack.from_json(by_lengths.to_json())
    assert again.base.sigma_s == (3.0, 1.0) and again.base.albedo is None
    assert Stack([], HalfSpace(0.75)).to_json()["base"] == {
        "kind": "half-space", "albedo": 0.75, "phase": {"kind": "isotropic"}}
    assert lamina.solve(by_lengths).reflectance(1.0) == pytest.approx(
        lamina.solve(Stack([], HalfSpace([0.75, 0.5]))).reflectance(1.0))
    with pytest.raises(lamina.StackError, match="base.sigma_a is missing"):
        Stack([], HalfSpace(sigma_s=1.0))

# SPDX-License-Identifier: GPL-3.0-or-later
"""Exported .bsdf files as Mitsuba 3 reads them: values, sampling, channels and wavelengths."""

import mitsuba as mi
import numpy as np
import pytest
from mitsuba_scenes import evaluate, furnace, measured
from z_limit import z_limit

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack
from lamina.rgl import save_bsdf

BODY = Medium(albedo=0.9, tau=1.0, phase=HenyeyGreenstein(0.6))
STACKS = {
    "colours": Stack([Medium(albedo=[0.9, 0.8, 0.6], tau=2.0, phase=HenyeyGreenstein(0.5))], Lambert([0.5, 0.3, 0.1])),
    "rough coat": Stack([Interface(ior=1.5, alpha=0.1), BODY], Lambert(0.5)),
    "smooth coat": Stack([Interface(ior=1.5), BODY], Lambert(0.5)),
    "dust on metal": Stack([Medium(albedo=0.5, tau=0.2)], Conductor(0.2, 3.9, alpha=0.2)),
    "sheet": Stack([Medium(albedo=[0.2, 0.7, 0.99], tau=0.5, phase=HenyeyGreenstein(-0.3))]),
}


@pytest.fixture(scope="module")
def solved():
    return {name: lamina.solve(stack) for name, stack in STACKS.items()}


def directions(count, seed):
    """Cosine-weighted pairs, without the grazing 3 degrees, and all azimuths."""
    random = np.random.default_rng(seed)
    cosines = np.sqrt(random.uniform(0.0025, 1.0, (2, count)))
    return *cosines, random.uniform(0.0, 2.0 * np.pi, count)


def error(bsdf, solution):
    """The mean error over random pairs of directions, relative to the mean value."""
    mu_o, mu_i, dphi = directions(600, seed=1)
    got = evaluate(bsdf, mu_o, mu_i, dphi)
    exact = np.broadcast_to(solution.brdf(mu_o, mu_i, dphi) * mu_o[:, None], got.shape)
    return np.abs(got - exact).sum() / exact.sum()


@pytest.mark.parametrize("name", STACKS)
def test_values(name, solved, tmp_path):
    """Readers interpolate linearly in all variables, so half the steps give a quarter of the error; at the default size
    it is below .3 %."""
    errors = []
    for size, angles in ((32, 16), (64, 32)):
        save_bsdf(solved[name], tmp_path / "out.bsdf", size, angles)
        errors.append(error(measured(tmp_path / "out.bsdf"), solved[name]))
    assert errors[1] < 3e-3 and 3.0 < errors[0] / errors[1] < 5.5, errors


def test_nodes_of_a_narrow_lobe_hold_the_function(tmp_path):
    """At oblique incidence too, where a table of uniform azimuths was off by .8 % of the mean."""
    solution = lamina.solve(Stack([Interface(ior=1.5, alpha=0.05), BODY], Lambert(0.5)))
    save_bsdf(solution, tmp_path / "out.bsdf", 48, 12)
    tensors = mi.tensor_io.read(str(tmp_path / "out.bsdf"))
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 48), np.linspace(0.0, 1.0, 48))
    theta, phi = 0.5 * np.pi * u * u, (2.0 * v - 1.0) * np.pi
    half = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    for index in (0, 3, 6):  # up to 72 degrees
        angle = float(tensors["theta_i"][index])
        light = np.array([np.sin(angle), 0.0, np.cos(angle)])
        out = 2.0 * (half @ light)[..., None] * half - light
        seen = out[..., 2] > 0.02
        x, y, z = out[seen].T
        exact = solution.brdf(np.minimum(z, 1.0), np.cos(angle), np.arctan2(y, -x))[:, 0] * z
        got = np.asarray(tensors["rgb"])[0, index, 0][seen]
        assert np.abs(got - exact).sum() < 5e-3 * exact.sum(), np.degrees(angle)


def test_pbrt_finds_the_function_too(tmp_path):
    """By the fields that pbrt-v4's MeasuredBxDFData::Create requires, and the formula of its MeasuredBxDF::f at nodes:
    spectra ndf / (4 sigma cos), whatever `jacobian` says."""
    stack = Stack([Medium(albedo=[0.4, 0.6, 0.9], tau=1.0)], Lambert([0.1, 0.2, 0.3]))
    solution = lamina.solve(stack)
    save_bsdf(solution, tmp_path / "out.bsdf", 32, 8, wavelengths=[650.0, 550.0, 450.0])
    fields = mi.tensor_io.read(str(tmp_path / "out.bsdf"))
    shapes = {name: np.asarray(fields[name]).shape for name in fields if name != "description"}
    assert shapes == {"phi_i": (1,), "theta_i": (8,), "wavelengths": (3,), "jacobian": (1,), "ndf": (2, 2),
                      "sigma": (2, 2), "vndf": (1, 8, 2, 2), "luminance": (1, 8, 32, 32), "spectra": (1, 8, 3, 32, 32)}
    assert {np.asarray(fields[name]).dtype.name for name in shapes} == {"float32", "uint8"}
    factor = np.asarray(fields["ndf"]) / (4.0 * np.asarray(fields["sigma"]))
    angle, u = float(np.asarray(fields["theta_i"])[2]), 8
    # The first azimuth, -pi, tilts the half vector away from the light: both directions lie in one plane.
    away = angle + np.pi * (u / 31)**2
    got = np.asarray(fields["spectra"])[0, 2, :, 0, u] * factor.max() / np.cos(away)
    exact = solution.brdf(np.cos(away), np.cos(angle), 0.0).ravel()[::-1]
    assert factor.min() == factor.max()
    assert np.allclose(got, exact, rtol=2e-3), (got, exact)


@pytest.mark.parametrize("name", ["rough coat", "dust on metal"])
def test_no_value_is_negative(name, solved, tmp_path):
    """Down to grazing directions, in coarse files too. Values were continued below the horizon with negative ones."""
    random = np.random.default_rng(3)
    mu_o, mu_i = random.uniform(0.002, 1.0, (2, 20000))
    for size, angles in ((16, 8), (64, 32)):
        save_bsdf(solved[name], tmp_path / "out.bsdf", size, angles)
        got = evaluate(measured(tmp_path / "out.bsdf"), mu_o, mu_i, random.uniform(0.0, 2.0 * np.pi, 20000))
        assert got.min() >= 0.0 and got.mean() > 0.0
        assert mi.tensor_io.read(str(tmp_path / "out.bsdf"))["rgb"].min() >= 0.0


@pytest.mark.parametrize("name", STACKS)
def test_sampling_returns_the_albedo(name, solved, tmp_path):
    save_bsdf(solved[name], tmp_path / "out.bsdf")
    bsdf = measured(tmp_path / "out.bsdf")
    for seed, mu in enumerate((1.0, 0.7, 0.25)):
        mean, error, pdf_error = furnace(bsdf, mu, 3000, seed)
        exact = solved[name].reflectance(mu, parts=True)[0]
        # Noise, in addition to the interpolation error of .3 %.
        allowed = z_limit(3 * exact.size * len(STACKS)) * error + 3e-3 * exact
        assert np.all(np.abs(mean - exact) < allowed), (mu, mean, error, exact)
        # Importance sampling: weights scatter by less than half of their mean.
        assert np.all(error * 3000**0.5 < 0.5 * mean)
        assert pdf_error < 0.01


def test_white_furnace(tmp_path):
    """A conservative stack reflects all light: 1, also in Mitsuba."""
    white = Stack([Interface(ior=1.4, alpha=0.3), Medium(albedo=1.0, tau=0.5)], Lambert(1.0))
    save_bsdf(lamina.solve(white), tmp_path / "white.bsdf")
    bsdf = measured(tmp_path / "white.bsdf")
    for seed, mu in enumerate((0.95, 0.5, 0.2)):
        mean, error, _ = furnace(bsdf, mu, 3000, 10 + seed)
        assert np.all(np.abs(mean - 1.0) < z_limit(3) * error + 3e-3)


def test_wavelengths(solved, tmp_path):
    """A file for spectral renderers: channels at their wavelengths, linear between, whatever their order."""
    path = tmp_path / "spectral.bsdf"
    save_bsdf(solved["colours"], path, wavelengths=[630.0, 532.0, 465.0])
    bsdf = measured(path, "scalar_spectral")
    mu_o, mu_i, dphi = directions(40, seed=2)
    got = evaluate(bsdf, mu_o, mu_i, dphi, [630.0, 532.0, 465.0, 581.0])
    exact = solved["colours"].brdf(mu_o, mu_i, dphi) * mu_o[:, None]
    assert got[:, :3] == pytest.approx(exact, rel=0.03)
    assert np.abs(got[:, :3] - exact).sum() < 3e-3 * exact.sum()
    assert got[:, 3] == pytest.approx(got[:, :2].mean(axis=1), rel=1e-4)
    with pytest.raises(RuntimeError, match="spectral variant"):
        measured(path, "scalar_rgb")


def test_equal_files_and_what_they_leave_out(solved, tmp_path):
    """The share left out is Fresnel's mirror image at the most grazing slice; 0 for a matched layer."""
    left = save_bsdf(solved["smooth coat"], tmp_path / "a.bsdf", 16, 8)
    assert 0.98 < left < 1.0
    save_bsdf(lamina.solve(STACKS["smooth coat"], threads=1), tmp_path / "b.bsdf", 16, 8)
    assert (tmp_path / "a.bsdf").read_bytes() == (tmp_path / "b.bsdf").read_bytes()
    assert save_bsdf(solved["colours"], tmp_path / "c.bsdf", 16, 8) == 0.0
    text = mi.tensor_io.read(str(tmp_path / "a.bsdf"))["description"].tobytes().decode()
    assert "grey" in text and "without mirror reflection" in text


def test_black_has_a_density(tmp_path):
    save_bsdf(lamina.solve(Stack([], lamina.Black())), tmp_path / "black.bsdf", 16, 8)
    mean, error, _ = furnace(measured(tmp_path / "black.bsdf"), 0.6, 100, 0)
    assert np.all(mean == 0.0) and np.all(error == 0.0)


@pytest.mark.parametrize("arguments, sentence", [
    ({"size": 4}, r"size = 4: must be a whole number in \[8, 1024\]"),
    ({"angles": 2.5}, r"angles = 2.5: must be a whole number in \[4, 512\]"),
    ({"wavelengths": [500.0]}, r"wavelengths = \[500.0\]: must be one for each of 3 channel"),
    ({"wavelengths": [500.0, 600.0, 500.0]}, "must be positive nanometres, all different"),
])
def test_bad_arguments(solved, tmp_path, arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        save_bsdf(solved["colours"], tmp_path / "out.bsdf", **arguments)
    assert not list(tmp_path.iterdir())

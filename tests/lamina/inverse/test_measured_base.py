# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured bases from files: MERL, written here from a function, and RGL, written by Lamina and read by Mitsuba too."""

import math
import warnings

import numpy as np
import pytest
from measured_tables import facets, vectors
from test_files import merl_file, random_bsdf

import lamina
from lamina import HenyeyGreenstein, Interface, Lambert, MeasurementError, Medium, Stack
from lamina.measurements import load_base

PAINT = facets(0.15, 0.05, 0.3)


def merl_cells(function):
    """The values of a function at the centres of the cells, and -1 below the horizon, as in the files of MERL."""
    i, j, k = np.indices((90, 90, 180))
    half, theta, phi = np.radians((i + 0.5)**2 / 90.0), np.radians(j + 0.5), np.radians(k + 0.5)
    x, y, z = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
    wi, wo = (np.stack([np.cos(half) * sign * x + np.sin(half) * z, sign * y,
                        np.cos(half) * z - np.sin(half) * sign * x], axis=-1) for sign in (1.0, -1.0))
    seen = (wi[..., 2] > 0.01) & (wo[..., 2] > 0.01)
    return np.where(seen, function(*(np.where(seen[..., None], w, [0.0, 0.0, 1.0]) for w in (wi, wo))), -1.0)


def errors(base, function, least):
    solved = lamina.solve(Stack([], base))
    rng = np.random.default_rng(1)
    mu_o, mu_i, dphi = rng.uniform(least, 1.0, (3, 400))
    dphi = math.pi * dphi
    return solved.brdf(mu_o, mu_i, dphi) / function(*vectors(mu_o, mu_i, dphi))[:, None] - 1.0


def test_merl(tmp_path):
    path = merl_file(tmp_path / "paint.binary", merl_cells(PAINT))
    base = load_base(path)
    assert base.name == "paint" and base.channels == 1
    found = errors(base, PAINT, 0.2)
    assert np.sqrt(np.mean(found**2)) < 2e-3 and np.abs(found).max() < 0.02
    # Grazing light crosses cells of one degree, of which some have no values.
    assert np.sqrt(np.mean(errors(base, PAINT, 0.06)**2)) < 0.02


def test_merl_data_that_gain_light_are_scaled_down(tmp_path):
    def shiny(wi, wo):
        return facets(0.15, 0.9, 0.0)(wi, wo) * (1.0 + 0.5 / (wi[..., 2] + wo[..., 2]))
    path = merl_file(tmp_path / "shiny.binary", merl_cells(shiny))
    with pytest.warns(UserWarning, match="the data reflect up to .* times the light that they receive"):
        base = load_base(path, "chrome")
    solved = lamina.solve(Stack([], base))
    shares = solved.reflectance(np.array([0.05, 0.1, 0.2, 0.5, 1.0]))
    assert base.name == "chrome" and shares.max() < 1.0 and shares.min() > 0.9
    mu_o, mu_i = np.array([0.3, 0.9]), np.array([0.5, 0.2])
    assert solved.brdf(mu_o, mu_i, 0.4) == pytest.approx(solved.brdf(mu_i, mu_o, 0.4), rel=1e-6)


def test_a_stack_comes_back_from_its_bsdf_file(tmp_path):
    paint = Stack([Interface(1.5, alpha=0.2), Medium(albedo=[0.9, 0.7, 0.5], tau=2.0, phase=HenyeyGreenstein(0.4))],
                  Lambert(0.3))
    solved = lamina.solve(paint)
    lamina.rgl.save_bsdf(solved, tmp_path / "paint.bsdf", size=128, angles=64)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        base = load_base(tmp_path / "paint.bsdf")
    again = lamina.solve(Stack([], base))
    rng = np.random.default_rng(1)
    mu_o, mu_i, dphi = rng.uniform(0.1, 1.0, (3, 300))
    found = again.brdf(mu_o, mu_i, math.pi * dphi) / solved.brdf(mu_o, mu_i, math.pi * dphi) - 1.0
    assert np.sqrt(np.mean(found**2)) < 1.5e-3 and np.abs(found).max() < 0.01
    mu = np.array([0.2, 0.6, 1.0])
    assert again.reflectance(mu) == pytest.approx(solved.reflectance(mu), rel=2e-3)


@pytest.mark.parametrize("jacobian", [0, 1])
def test_rgl_values_are_those_of_mitsuba(tmp_path, jacobian):
    """The mean of both directions of random tables, whose densities warp the grid."""
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    path = random_bsdf(tmp_path / "x.bsdf", jacobian)
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(path)})
    at, context = mitsuba.SurfaceInteraction3f(), mitsuba.BSDFContext()
    from lamina.inverse.rgl import rgl_at
    from lamina.material.half_table import knots
    h, d, c, *_ = knots()
    found = rgl_at(path, h, d, c)
    rng = np.random.default_rng(1)
    compared = 0
    for place in zip(*(rng.integers(2, size - 2, 400) for size in h.shape), strict=True):
        x, y, z = np.sin(d[place]) * c[place], np.sin(d[place]) * math.sqrt(1.0 - c[place]**2), np.cos(d[place])
        one, other = (np.array([np.sin(h[place]) * z - np.cos(h[place]) * sign * x, sign * y,
                                np.cos(h[place]) * z + np.sin(h[place]) * sign * x]) for sign in (1.0, -1.0))
        if max(one[2], other[2]) > math.cos(0.1) or min(one[2], other[2]) < math.cos(1.4):
            continue  # outside the incident angles of the tables
        values = []
        for wi, wo in ((one, other), (other, one)):
            at.wi = mitsuba.Vector3f(*wi)
            values.append(np.array(bsdf.eval(context, at, mitsuba.Vector3f(*wo))) / wo[2])
        assert found[place] == pytest.approx(np.sqrt(values[0] * values[1]), rel=3e-3)
        compared += 1
    assert compared > 100


def test_spectra_become_colours(tmp_path):
    spectra = np.full((1, 5, 81, 9, 9), 0.05)
    path = random_bsdf(tmp_path / "x.bsdf", 0, rgb=None, spectra=spectra, wavelengths=np.linspace(380.0, 780.0, 81),
                       vndf=np.ones((1, 5, 2, 2)))
    with pytest.warns(UserWarning, match="times the light that they receive"):  # f cos is constant
        base = load_base(path)
    values = lamina.solve(Stack([], base)).brdf(0.8, 0.6, 1.0)
    assert values == pytest.approx(np.full(values.shape, 0.05 * math.sqrt(1.0 / 0.48)), rel=5e-3)


def test_bad_files(tmp_path):
    (tmp_path / "x.txt").write_text("x")
    with pytest.raises(MeasurementError, match=r"unknown format: a measured base must be \.binary"):
        load_base(tmp_path / "x.txt")
    (tmp_path / "x.binary").write_bytes(b"x")
    with pytest.raises(MeasurementError, match=r"must be a \.binary file of MERL"):
        load_base(tmp_path / "x.binary")
    with pytest.raises(MeasurementError, match="has no values"):
        load_base(merl_file(tmp_path / "dark.binary", np.full((90, 90, 180), -1.0)))
    with pytest.raises(MeasurementError, match="not finite"):
        load_base(merl_file(tmp_path / "nan.binary", np.full((90, 90, 180), np.nan)))
    with pytest.raises(MeasurementError, match=r"must be a \.bsdf file of RGL"):
        (tmp_path / "x.bsdf").write_bytes(b"x")
        load_base(tmp_path / "x.bsdf")
    with pytest.raises(OSError, match="nowhere"):
        load_base(tmp_path / "nowhere.binary")


def test_noisy_cells_can_be_solved(tmp_path):
    """Noise of 15 % in each cell: beside dust, at the final tolerance, and with the right energy."""
    def paint(wi, wo):
        return 0.7 * (facets(0.05, 0.04, 0.0)(wi, wo) + facets(0.25, 0.15, 0.1)(wi, wo))
    cells = merl_cells(paint)
    noise = np.exp(0.15 * np.random.default_rng(0).normal(size=cells.shape) - 0.5 * 0.15**2)
    base = load_base(merl_file(tmp_path / "noisy.binary", np.where(cells > 0.0, cells * noise, cells)))
    clean = load_base(merl_file(tmp_path / "clean.binary", cells))
    dust = Medium(albedo=0.9, tau=0.3, phase=HenyeyGreenstein(0.5))
    for layers in ([], [dust], [Interface(1.5)]):
        noisy, wanted = (lamina.solve(Stack(layers, one)).reflectance([0.3, 0.8]) for one in (base, clean))
        assert noisy == pytest.approx(wanted, rel=0.01)

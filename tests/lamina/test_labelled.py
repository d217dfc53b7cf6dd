# SPDX-License-Identifier: GPL-3.0-or-later
"""Solutions and tables as xarray datasets: axes by name, units, and the numbers themselves."""

import sys

import numpy as np
import pytest

import lamina
from lamina import Lambert, Medium, PrincipledBase, Stack

SHEET = Stack([Medium([0.9, 0.8, 0.6], 1.0), Medium(0.5, 0.3)])


def test_a_solution():
    solved = lamina.solve(SHEET, "preview")
    data = solved.to_xarray()
    assert dict(data.sizes) == {"side": 2, "mu_o": 20, "mu_i": 20, "dphi": 13, "channel": 3}
    for name, call in (("brdf", solved.brdf), ("btdf", solved.btdf)):
        value = data[name].sel(side="bottom", channel="green").isel(mu_o=3, mu_i=7, dphi=2)
        exact = call(float(value.mu_o), float(value.mu_i), float(value.dphi), "bottom")[1]
        assert float(value) == pytest.approx(exact, rel=1e-9) and value.attrs["units"] == "1/sr"
    assert data.transmittance.sel(side="top").values == pytest.approx(solved.transmittance(data.mu_i.values))
    assert data.dphi.attrs["units"] == "rad" and data.attrs["stack_hash"] == SHEET.hash
    gray = lamina.solve(Stack([Medium(0.9, 1.0)], Lambert(0.5)), "preview").to_xarray(mu_o=0.5, mu_i=[0.1, 1.0], dphi=0)
    assert gray.brdf.shape == (1, 1, 2, 1, 1) and "btdf" not in gray


def test_a_table():
    dust = Medium([0.9, 0.8, 0.6], 1.0, varying=True)
    lut = lamina.bake(Stack([dust], Lambert(0.5)), "preview", row_stride=8)
    data = lut.to_xarray()
    assert dict(data.weights.sizes) == {
        "side": 1, "closure": len(lut.closures), "roughness": 1, "tau": 33, "view_angle": 64, "color": 3}
    assert data.weights.sel(closure=lut.closures[1], tau=1.0, color="blue").values.ravel() == pytest.approx(
        lut.weights[0, 1, 32, :, 2])
    assert np.cos(data.view_angle.values) == pytest.approx(data.mu_o.values) and data.mu_o.dims == ("view_angle",)
    assert data.slice_errors.sel(channel="red").shape == (1, 1, 33, 64)
    assert data.weights.attrs["units"] == "1" and data.view_angle.attrs["units"] == "rad"


def test_a_table_with_roughness():
    base = PrincipledBase([0.5, 0.3, 0.1], inputs=("roughness",))
    lut = lamina.bake(Stack([Medium(0.9, 0.5)], base), "preview")
    data = lut.to_xarray()
    weights = data.weights
    assert data.slice_errors.dims == ("side", "tau", "channel", "view_angle")  # at the base's own roughness
    assert data.slice_errors.shape == (1, 1, 3, 64)
    assert weights.sel(roughness=0.4).values.reshape(-1, 64, 3) == pytest.approx(lut.weights[0, :, 2])


def test_without_xarray_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(lamina.ExtraMissing, match=r'^to_xarray needs xarray, .*: pip install xarray$'):
        lamina.solve(SHEET, "preview").to_xarray()

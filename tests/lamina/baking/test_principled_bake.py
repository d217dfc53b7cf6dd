# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of Principled bases without Blender: the strip of the BSDF, the axes, and what is refused. Values are measured
in Cycles by tests/cycles/test_principled_base.py."""

from dataclasses import replace

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Lut, Medium, PrincipledBase, Stack
from lamina.baking.bases.principled import ROUGH_ROWS
from lamina.baking.fit.between_rows import spread
from lamina.baking.fit.mixture import Part
from lamina.baking.fit.slices import SolvedRows
from lamina.closures.closure_table import view_cosines
from lamina.kinds.table import PRINCIPLED, ROUGHNESS_ROWS, TAU_ROWS, THROWN_BACK

DUST = Medium(albedo=[0.9, 0.8, 0.7], tau=1.0, phase=HenyeyGreenstein(0.5), varying=True)


def test_without_layers_only_the_bsdf_has_a_weight():
    lut = lamina.bake(Stack([DUST], PrincipledBase(color=0.5, roughness=0.6)), "preview", row_stride=8)
    strips = dict(zip(lut.closures, lut.weights[0], strict=True))
    own = strips.pop(PRINCIPLED)
    assert own[0] == pytest.approx(1.0)
    assert not any(np.any(strip[0]) for strip in strips.values())
    # Along the normal, light of a narrow lobe is attenuated twice; that of a broad lobe somewhat more.
    assert np.exp(-2.6) < own[-1, 0, 0] < np.exp(-2.0)
    assert np.all(np.diff(own[:, 0, 0]) < 0.0)


def test_a_smooth_lobe_is_attenuated_twice():
    lut = lamina.bake(Stack([DUST], PrincipledBase(color=0.5, roughness=0.1)), "preview", row_stride=8)
    own = lut.weights[0, lut.closures.index(PRINCIPLED)]
    mu = np.cos(np.linspace(0.0, np.pi / 2, 64))[:60]
    assert own[-1, :60, 0] == pytest.approx(np.exp(-2.0 / mu), abs=1e-6)


def test_the_axes_and_strips_of_inputs(tmp_path):
    base = PrincipledBase(color=[0.8, 0.3, 0.1], roughness=0.4, inputs=("color", "metallic", "roughness"))
    lut = lamina.bake(Stack([DUST], base), "preview", row_stride=16)
    assert lut.weights.shape[2] == TAU_ROWS * ROUGHNESS_ROWS
    assert lut.header["axes"]["roughness"] == {"count": 6, "values": [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]}
    assert {PRINCIPLED, THROWN_BACK, "metal/" + THROWN_BACK} <= set(lut.closures)
    thrown_back = lut.weights[0, lut.closures.index(THROWN_BACK)]
    assert thrown_back.min() >= 0.0 and thrown_back.max() < 1.0
    lut.save(tmp_path / "table.npz")
    again = Lut.load(tmp_path / "table.npz")
    assert np.array_equal(again.weights, lut.weights) and again.header == lut.header
    # The closures of an earlier table give the same layout.
    assert lamina.bake(Stack([DUST], base), "preview", row_stride=16, closures=lut.closures).closures == lut.closures


def test_a_metal_with_a_color_input_is_fitted_nearly_as_well_as_with_a_fixed_color():
    base = PrincipledBase(color=[0.8, 0.4, 0.1], metallic=1.0, roughness=0.35)
    dust = replace(DUST, albedo=[0.9, 0.88, 0.84], tau=2.0, phase=HenyeyGreenstein(0.6))
    fixed, colored = (lamina.bake(Stack([dust], replace(base, inputs=inputs)), "preview").report["row_errors"]
                      for inputs in ((), ("color",)))
    for row in np.searchsorted(fixed["tau"], (0.1, 0.5, 2.0)):
        assert colored["mean"][row] < 1.4 * fixed["mean"][row], fixed["tau"][row]


@pytest.mark.parametrize("inputs", [("color", "roughness"), ("roughness",)])
def test_the_albedo_between_solved_thicknesses(inputs):
    base = PrincipledBase(color=0.6, metallic=1.0, roughness=0.4, inputs=inputs)  # 0.4 is a row of the table
    lut = lamina.bake(Stack([DUST], base), "preview")
    mu, tau = np.array([0.9, 0.5, 0.2]), lut.header["axes"]["tau"]["values"]
    for row in (1, 4, 9, 15, 22, 29):
        assert row not in ROUGH_ROWS["preview"]
        exact = lamina.solve(Stack([replace(DUST, tau=tau[row], varying=False)], replace(base, inputs=())))
        assert lut.reflectance(mu, tau=tau[row]) == pytest.approx(exact.reflectance(mu), rel=0.01)


def test_splines_keep_the_albedo_and_the_sign():
    axis = list(range(TAU_ROWS))
    solved = SolvedRows(axis, [0, 2, 6, 12, 18, 25, 32], [], [], ["top"], False)
    rows, columns = np.array(axis) / 32.0, len(view_cosines())
    # One closure enters where another leaves; the sum is a cubic
    enters = np.maximum(rows - 0.4, 0.0) ** 2
    exact = np.stack([1.0 + rows - rows**3 - enters, enters])
    known = np.broadcast_to(exact[None, :, solved.rows, None, None], (1, 2, len(solved.rows), 1, columns))
    found = spread(Part.of(["diffuse", "diffuse"], known), solved)[0, :, :, 0]
    assert found.min() == 0.0
    assert found[:, solved.rows] == pytest.approx(np.repeat(exact[:, solved.rows, None], columns, axis=2), abs=1e-12)
    assert found.sum(axis=0) == pytest.approx(np.repeat(exact.sum(axis=0)[:, None], columns, axis=1), abs=1e-12)


@pytest.mark.parametrize("stack", [Stack([DUST], PrincipledBase()),
                                   Stack([Interface(ior=1.5)], PrincipledBase(inputs=("color",)))])
def test_a_table_without_its_numbers_is_refused(tmp_path, stack):
    lut = lamina.bake(stack, "preview", row_stride=32)
    header = {**lut.header, "stack": {**lut.header["stack"], "base": {"kind": "principled"}}}
    Lut(header, lut.weights).save(tmp_path / "broken.npz")
    with pytest.raises(lamina.LutError, match="stack.base.color: must be a list of numbers from 0"):
        Lut.load(tmp_path / "broken.npz")

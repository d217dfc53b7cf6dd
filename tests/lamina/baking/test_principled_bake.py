# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of Principled bases without Blender: the strip of the BSDF, the axes, and what is refused. Values are measured
in Cycles by tests/cycles/test_principled_base.py."""

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Lut, Medium, PrincipledBase, Stack
from lamina.kinds.table import METAL, PRINCIPLED, ROUGHNESS_ROWS, TAU_ROWS, THROWN_BACK

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
    assert {PRINCIPLED, THROWN_BACK, METAL + THROWN_BACK} <= set(lut.closures)
    thrown_back = lut.weights[0, lut.closures.index(THROWN_BACK)]
    assert thrown_back.min() >= 0.0 and thrown_back.max() < 1.0
    lut.save(tmp_path / "table.npz")
    again = Lut.load(tmp_path / "table.npz")
    assert np.array_equal(again.weights, lut.weights) and again.header == lut.header
    # The closures of an earlier table give the same layout.
    assert lamina.bake(Stack([DUST], base), "preview", row_stride=16, closures=lut.closures).closures == lut.closures


@pytest.mark.parametrize("stack", [Stack([DUST], PrincipledBase()),
                                   Stack([Interface(ior=1.5)], PrincipledBase(inputs=("color",)))])
def test_a_table_without_its_numbers_is_refused(tmp_path, stack):
    lut = lamina.bake(stack, "preview", row_stride=32)
    header = {**lut.header, "stack": {**lut.header["stack"], "base": {"kind": "principled"}}}
    Lut(header, lut.weights).save(tmp_path / "broken.npz")
    with pytest.raises(lamina.LutError, match="stack.base.color: must be a list of numbers from 0"):
        Lut.load(tmp_path / "broken.npz")

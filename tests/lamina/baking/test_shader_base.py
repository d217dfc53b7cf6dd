# SPDX-License-Identifier: GPL-3.0-or-later
"""A base that another shader renders: its weight in the table, and the errors that the report states."""

import numpy as np
import pytest

import lamina
from lamina import Interface, Lambert, Lut, Medium, ShaderBase, Stack
from lamina.baking.bases.shader import METAL
from lamina.common.srgb import LUMINANCE
from lamina.kinds.table import BASE_WEIGHT, THROWN_BACK

LAYERS = [Interface(1.5), Medium(albedo=0.9, tau=0.3)]
COLUMN_COSINES = np.maximum(np.cos(np.linspace(0.0, np.pi / 2, 64)), 6e-3)
SKY = np.sin(np.linspace(0.0, np.pi, 64)) / np.sin(np.linspace(0.0, np.pi, 64)).sum()


@pytest.fixture(scope="module")
def lut():
    return lamina.bake(Stack(LAYERS, ShaderBase(0.5)), quality="preview")


def strip(lut, name, row=0):
    return lut.weights[0, lut.closures.index(name), row].astype(float)  # [column, R G B]


def reflected(layers, base):
    return lamina.solve(Stack(layers, base), "preview").reflectance(COLUMN_COSINES)


def shown(lut, own, told, row=0):
    """Light towards each view over a shader of directional albedo `own`: layers over black, and the weighted shader."""
    weight = strip(lut, BASE_WEIGHT, row) / (1.0 - told * strip(lut, THROWN_BACK, row))
    black = reflected(LAYERS, lamina.Black())
    return black + (weight @ np.array(LUMINANCE))[:, None] * own


def test_the_weight_is_between_those_of_lambert_and_metal(lut):
    """The weights that would be exact follow from solved stacks alone."""
    told, back = 0.9, strip(lut, THROWN_BACK)[:, 0]
    black = reflected(LAYERS, lamina.Black())[:, 0]
    white = (reflected(LAYERS, Lambert(1.0))[:, 0] - black) * (1.0 - back)
    bare = reflected([Medium(albedo=0.5, tau=0.0)], METAL)[:, 0]
    metal = (reflected(LAYERS, METAL)[:, 0] - black) / bare * (1.0 - told * back)
    assert strip(lut, BASE_WEIGHT)[:, 0] == pytest.approx(np.sqrt(white * metal), rel=2e-3)
    gains = [(reflected(LAYERS, Lambert(rho))[0, 0] - black[0]) / rho for rho in (0.25, 1.0)]
    assert gains[1] / gains[0] == pytest.approx((1.0 - 0.25 * back[0]) / (1.0 - back[0]), rel=2e-3)


def test_the_report_states_the_error_of_the_energy(lut):
    stated = lut.report["base_error"]
    matte = [SKY @ shown(lut, rho, rho) / (SKY @ reflected(LAYERS, Lambert(rho))) - 1.0 for rho in (0.2, 0.5, 0.8)]
    bare = reflected([Medium(albedo=0.5, tau=0.0)], METAL)
    metal = SKY @ shown(lut, bare, 0.9) / (SKY @ reflected(LAYERS, METAL)) - 1.0
    assert stated["lambert"] == pytest.approx(np.abs(matte).max(), abs=1e-3)
    assert stated["metal"] == pytest.approx(np.abs(metal).max(), abs=1e-3)
    worst = max(stated["lambert"], stated["metal"])
    assert worst < 0.05 and stated["color"] == pytest.approx(worst) and stated["unknown"] > worst


def test_layers_without_effect_leave_the_shader_alone():
    lut = lamina.bake(Stack([Medium(albedo=0.9, tau=0.5, varying=True)], ShaderBase([0.5, 0.4, 0.3])), "preview")
    assert strip(lut, BASE_WEIGHT, 0) == pytest.approx(1.0, abs=1e-4)
    assert strip(lut, THROWN_BACK, 0) == pytest.approx(0.0, abs=1e-4)
    others = [index for index, name in enumerate(lut.closures) if name not in (BASE_WEIGHT, THROWN_BACK)]
    assert np.abs(lut.weights[0, others, 0]).max() < 1e-6


def test_tinted_layers_say_that_they_do_not_tint():
    lut = lamina.bake(Stack([Medium(albedo=[0.9, 0.6, 0.2], tau=1.0)], ShaderBase(0.5)), "preview")
    assert lut.report["base_error"]["color"] > 0.05 > lut.report["base_error"]["lambert"]


def test_the_table_does_not_depend_on_the_reflectance(lut, tmp_path):
    other = lamina.bake(Stack(LAYERS, ShaderBase(0.2)), quality="preview")
    assert np.array_equal(lut.weights, other.weights) and lut.header["stack_hash"] != other.header["stack_hash"]
    lut.save(tmp_path / "shader.npz")
    again = Lut.load(tmp_path / "shader.npz")
    assert again.report["base_error"] == lut.report["base_error"] and again.closures == lut.closures


def test_the_solver_takes_a_lambert_surface():
    stack = Stack(LAYERS, ShaderBase([0.2, 0.5, 0.8]))
    wanted = lamina.solve(Stack(LAYERS, Lambert([0.2, 0.5, 0.8])))
    assert np.array_equal(lamina.solve(stack).reflectance(0.6), wanted.reflectance(0.6))
    assert Stack.from_json(stack.to_json()) == stack
    with pytest.raises(lamina.StackError, match=r"base.reflectance = 1.2: must lie in \[0, 1\]"):
        Stack(LAYERS, ShaderBase(1.2))

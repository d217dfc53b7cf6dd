# SPDX-License-Identifier: GPL-3.0-or-later
"""Pigments over bases whose color is an input of the node group: over gray, tables agree with the exact albedo."""

import functools
from dataclasses import replace

import numpy as np
import pytest

import lamina
from lamina import Interface, Lambert, Lut, Medium, PrincipledBase, ShaderBase, Spectrum, Stack, StackError

BLOOD = Medium(pigment="oxyhemoglobin", amount=0.02, sigma_s=2.0, thickness=0.3, varying=True)
TEA = Medium(pigment="brown-pigments", amount=0.5, sigma_s=0.0, thickness=0.05)
COLOR = (0.6, 0.4, 0.3)
TEXTURE = Lambert(COLOR, textured=True)
PRINCIPLED = PrincipledBase(color=COLOR, roughness=0.5, inputs=("color",))
GRAYS, MU = (0.1, 0.5, 0.9), (0.3, 0.7, 1.0)


@functools.cache
def baked(layers, base):
    """The table. Of layers of varying thickness, every eighth thickness is solved."""
    stack = Stack(layers, base)
    return lamina.bake(stack, "preview", row_stride=1 if stack.varying is None else 8)


def gray(base, value):
    """The base with this gray color, without inputs."""
    if isinstance(base, Lambert):
        return replace(base, reflectance=value, textured=False)
    return replace(base, color=value, inputs=())


@pytest.mark.parametrize(("layers", "base"), [
    ((BLOOD,), TEXTURE), ((Interface(1.5), TEA), TEXTURE), ((BLOOD,), PRINCIPLED), ((Interface(1.5), TEA), PRINCIPLED),
], ids=["haze on texture", "varnish on texture", "haze on Principled", "varnish on Principled"])
def test_tables_agree_with_the_exact_albedo_over_gray(layers, base):
    table = baked(layers, base)
    for value in GRAYS:
        solved = lamina.solve(Stack(layers, gray(base, value)), "preview")
        wanted = solved.stack.seen(solved.reflectance(MU))
        assert table.reflectance(MU, color=[value] * 3) == pytest.approx(wanted, rel=5e-3)


def test_each_channel_of_a_color_is_that_of_a_gray_base():
    table = baked((BLOOD,), TEXTURE)
    mixed = table.reflectance(MU, color=GRAYS)
    for index, value in enumerate(GRAYS):
        assert mixed[:, index] == pytest.approx(table.reflectance(MU, color=[value] * 3)[:, index], rel=1e-6)


def test_own_colors_and_files(tmp_path):
    """The default of the input is the given color, also after a round trip through a file."""
    table = baked((BLOOD,), PRINCIPLED)
    table.save(tmp_path / "blood.npz")
    again = Lut.load(tmp_path / "blood.npz")
    own = table.reflectance(MU, color=COLOR)
    assert np.array_equal(table.reflectance(MU), own) and np.array_equal(again.reflectance(MU), own)
    even = baked((replace(BLOOD, varying=False),), PRINCIPLED).report
    assert table.report["fit_error"] < 0.06 and even["input_error"]["albedo"]["error"] < 0.05


def test_a_shader_has_one_weight_and_its_errors_told():
    stack = Stack([BLOOD], ShaderBase(0.5))
    report = lamina.bake(stack, "preview").report
    assert 0.0 < report["base_error"]["lambert"] < 0.02 < report["base_error"]["color"]


@pytest.mark.parametrize("base", [TEXTURE, PRINCIPLED])
def test_an_input_has_no_spectrum(base):
    name = "reflectance" if isinstance(base, Lambert) else "color"
    with pytest.raises(StackError, match=rf"base.{name}: must be one number, or red, green and blue"):
        lamina.bake(Stack([BLOOD], replace(base, **{name: Spectrum((400, 700), (0.2, 0.8))})), "preview")


def test_varying_varnish_keeps_the_color_without_its_film():
    table = lamina.bake(Stack([Interface(1.5, varying=True), TEA], TEXTURE), "preview")
    assert table.reflectance(0.7, color=[0.5] * 3, coverage=0.0) == pytest.approx([0.5] * 3, rel=1e-3)


def test_errors_of_a_channel_without_light_do_not_count():
    """Rhodamine leaves almost no green light, whose errors cannot be seen."""
    table = lamina.bake(Stack([Medium(pigment="rhodamine", amount=0.1, sigma_s=1.0, thickness=1.0)], Lambert(0.8)),
                        "preview")
    red, green, _ = table.reflectance(0.7)
    assert green < 0.01 * red and table.report["fit_error"] < 0.07

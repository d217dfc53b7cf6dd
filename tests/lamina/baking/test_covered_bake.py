# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of Principled bases with inputs below an interface, without Blender: albedos at values of the inputs against
lamina.solve, strips and axes. Slices are measured in Cycles by tests/cycles/test_covered_principled.py."""

from dataclasses import replace

import numpy as np
import pytest

import lamina
from lamina import Interface, Lut, Medium, PrincipledBase, Stack
from lamina.closures import closure_table, following_lobes
from lamina.kinds.table import AGAIN, DARK, FIRST, THROWN_BACK, TRAPPED, Strip

VARNISH, ROUGH = Interface(ior=1.5), Interface(ior=1.5, alpha=0.15)
METAL = "metal/"
COLUMNS = [0, 25, 45, 55]
ALBEDO = 0.02


def albedo(lut, color, metallic=None):
    """The directional albedo that the node group shows at the first roughness, [column], by the formulas in
    baking.bases.covered; `metallic` if that is an input."""
    strips = {name: lut.weights[0, k, 0, COLUMNS, 0].astype(float) for k, name in enumerate(lut.closures)}
    shares = {"": 1.0} if metallic is None else {"": 1.0 - metallic, METAL: metallic}
    total = np.zeros(len(COLUMNS))
    for name, weight in strips.items():
        closure, prefix = Strip.of(name).closure, METAL if name.startswith(METAL) else ""
        if not closure:
            continue
        factor, back = shares[prefix], strips.get(prefix + THROWN_BACK, 0.0)
        if metallic is not None and not prefix:
            back = (1.0 - metallic) * back + metallic * strips[TRAPPED]
        kind = name.removeprefix(prefix).removesuffix(closure)
        factor = {"": 1.0, DARK: factor, FIRST: factor * color,
                  AGAIN: factor * color**2 * (1.0 - back) / (1.0 - color * back)}[kind]
        own = 1.0
        if not closure.startswith("mirror:"):
            grid = closure_table.light_grid(8, 8)
            own = closure_table.only(grid, False, (closure,)).albedo[COLUMNS, 0]
        total = total + factor * weight * own
    return total


def exact(layers, base, **values):
    mu = closure_table.view_cosines()[COLUMNS]
    return lamina.solve(Stack(layers, replace(base, inputs=(), **values)), "preview").reflectance(mu)[:, 0]


@pytest.mark.parametrize("ior", [1.45, 1.7])
@pytest.mark.parametrize("layers", [[VARNISH], [ROUGH, Medium(albedo=0.7, tau=0.4)]],
                         ids=["smooth", "rough and medium"])
def test_a_textured_dielectric_has_the_exact_albedo(layers, ior):
    base = PrincipledBase(color=0.5, ior=ior, roughness=0.3, inputs=("color",))
    lut = lamina.bake(Stack(layers, base), "preview")
    for color in (0.05, 0.5, 0.9):
        assert albedo(lut, color) == pytest.approx(exact(layers, base, color=color), rel=2e-3)


@pytest.mark.parametrize("layers", [[VARNISH], [ROUGH]], ids=["smooth", "rough"])
@pytest.mark.parametrize("roughness", [0.3, 0.7])
def test_a_metal_mixed_with_a_dielectric(layers, roughness):
    base = PrincipledBase(color=0.5, roughness=roughness, inputs=("color", "metallic"))
    lut = lamina.bake(Stack(layers, base), "preview")
    for color, metallic in ((0.3, 1.0), (0.7, 1.0), (0.95, 1.0), (0.8, 0.5), (0.4, 0.25), (0.9, 0.8)):
        assert albedo(lut, color, metallic) == pytest.approx(exact(layers, base, color=color, metallic=metallic),
                                                             rel=ALBEDO), (color, metallic)


def test_the_axes_and_strips_of_inputs(tmp_path):
    base = PrincipledBase(color=[0.8, 0.3, 0.1], roughness=0.4, inputs=("color", "metallic", "roughness"))
    stack = Stack([Interface(ior=1.5, alpha=0.3)], base)
    lut = lamina.bake(stack, "preview")
    assert lut.header["axes"]["roughness"]["values"] == pytest.approx(np.linspace(0.0, 1.0, 11))
    assert lut.weights.shape[2] == 11
    assert {THROWN_BACK, METAL + THROWN_BACK, TRAPPED} <= set(lut.closures)
    assert any(Strip.of(name).closure.startswith(following_lobes.PREFIX) for name in lut.closures)
    lut.save(tmp_path / "table.npz")
    again = Lut.load(tmp_path / "table.npz")
    assert np.array_equal(again.weights, lut.weights) and again.header == lut.header
    # The closures of an earlier table give the same layout
    assert lamina.bake(stack, "preview", closures=lut.closures).closures == lut.closures


def test_dust_that_varies_above_varnish():
    dust = Medium(albedo=0.9, tau=1.0, varying=True)
    base = PrincipledBase(color=0.5, inputs=("color",))
    lut = lamina.bake(Stack([dust, VARNISH], base), "preview", row_stride=8)
    assert lut.weights.shape[2] == 33 and lut.report["fit_error"] < 0.06
    assert albedo(lut, 0.7) == pytest.approx(exact([VARNISH], base, color=0.7), rel=2e-3)


def test_a_colored_base_below_layers_of_one_channel():
    """Only the roughness is an input; each channel is that of a gray base."""

    def baked(color):
        base = PrincipledBase(color=color, metallic=0.3, roughness=0.5, inputs=("roughness",))
        return lamina.bake(Stack([VARNISH], base), quality="preview").reflectance(0.5, roughness=0.5)

    colors = (0.8, 0.4, 0.1)
    np.testing.assert_allclose(baked(colors), [baked(color)[0] for color in colors], rtol=1e-4)

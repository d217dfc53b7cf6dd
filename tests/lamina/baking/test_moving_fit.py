# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes that move with the view: their closed form, their albedo, and tables that hold them."""

import numpy as np
import pytest

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, LutError, Medium, Stack
from lamina.baking.table import real_time
from lamina.closures import lobes, moving_lobes, shaped_lobes
from lamina.closures.closure_table import light_grid
from lamina.closures.microfacet_lobes import ggx
from lamina.kinds.table import Strip

LACQUERED = Stack([Interface(1.5)], Conductor(facing=(1.0, 0.7837, 0.3427), grazing=(1.0, 0.8899, 0.6307), alpha=0.1))
DUSTY = Stack([Medium((0.8, 0.7, 0.5), 0.6, HenyeyGreenstein(0.6), varying=True)],
              Conductor(facing=(0.9532, 0.6392, 0.5365), grazing=(0.9613, 0.7717, 0.7204), alpha=0.2))
DENSE = light_grid(160, 160, 5.0)


@pytest.fixture(scope="module")
def lacquered():
    return lamina.bake(LACQUERED, "preview", basis="moving")


@pytest.fixture(scope="module")
def dusty():
    return lamina.bake(DUSTY, "preview", basis="moving")


def shapes_of(lut, number):
    return lut.weights[0, lut.closures.index(f"shape/moving:{number}")]


def random_shapes(count, seed):
    """Shapes whose normal is tilted by at most .5 rad, and views."""
    rng = np.random.default_rng(seed)
    mu_o, turn = rng.uniform(0.1, 0.95, count), rng.uniform(-0.2, 0.5, count)
    tilt = np.tan(turn) / (np.sqrt(1.0 - mu_o**2) - np.tan(turn) * mu_o)
    kept = (np.abs(tilt) < 1.0) & (np.cos(np.arccos(mu_o) - turn) > 0.1)
    return np.stack([rng.uniform(0.4, 0.9, count), rng.uniform(-0.6, 0.6, count), tilt], axis=1)[kept], mu_o[kept]


def test_a_shape_without_tilt_is_the_glossy_closure():
    for roughness, anisotropy in ((0.3, 0.0), (0.5, 0.4), (0.6, -0.3)):
        mu_i, dphi = DENSE.mu[::20, None], DENSE.dphi[None, ::20]
        wanted = ggx(roughness, anisotropy).evaluate(0.6, mu_i, dphi)
        assert moving_lobes.values([roughness, anisotropy, 0.0], 0.6, mu_i, dphi) == pytest.approx(wanted)


def test_both_implementations_agree():
    shapes, mu_o = random_shapes(40, 1)
    coarse = light_grid(12, 10)
    mine = moving_lobes.sampled(shapes, mu_o, coarse.mu, coarse.dphi)
    theirs = moving_lobes.values(shapes[:, None, None], mu_o[:, None, None], coarse.mu[:, None], coarse.dphi)
    assert mine == pytest.approx(theirs.reshape(mine.shape), rel=1e-9, abs=1e-9)


def test_the_albedo_is_the_integral_of_the_values():
    shapes, mu_o = random_shapes(60, 2)
    integral = moving_lobes.sampled(shapes, mu_o, DENSE.mu, DENSE.dphi) @ DENSE.solid_angle
    assert moving_lobes.albedos(shapes, mu_o) == pytest.approx(integral, rel=5e-3)


def test_gold_under_lacquer_keeps_the_bars(lacquered):
    assert lacquered.report["fit_error"] < 0.04 and lacquered.report["worst_slice"]["error"] < 0.11
    standard = lamina.bake(LACQUERED, "preview")
    assert standard.report["fit_error"] > 2.0 * lacquered.report["fit_error"]
    assert lacquered.report["closures"] == len(lacquered.closures) - 2 <= standard.report["closures"]


@pytest.mark.parametrize("which", ["lacquered", "dusty"])
def test_shapes_are_continuous(which, request):
    """No lobe changes places with the other, and no tilt runs away: second differences over the 64 views and first
    differences over the thicknesses are small. A swap changes the roughness by some .2 or more."""
    lut = request.getfixturevalue(which)
    for number in range(2):
        shape = shapes_of(lut, number)
        assert np.abs(np.diff(shape[..., 0], 2, axis=1)).max() < 0.08
        assert np.abs(np.diff(shape[..., 1], 2, axis=1)).max() < 0.3
        assert np.abs(np.diff(shape, axis=0)).max(initial=0.0) < 0.15
        assert np.abs(shape[..., 2]).max() < 3.0


@pytest.mark.parametrize("which", ["lacquered", "dusty"])
def test_the_report_is_measured_again_from_the_table(which, request):
    lut = request.getfixturevalue(which)
    found = lut.compare()
    assert found.mean == pytest.approx(lut.report["fit_error"], rel=1e-3)
    assert found.worst["error"] == pytest.approx(lut.report["worst_slice"]["error"], rel=1e-3)


def test_the_directional_albedo_is_exact(lacquered):
    mu = np.cos(np.array([4, 20, 40]) / 63 * np.pi / 2)  # columns of the table
    exact = lamina.solve(LACQUERED, quality="preview").reflectance(mu)
    assert lacquered.reflectance(mu) == pytest.approx(exact, rel=1e-4)


def test_values_between_columns_and_rows_use_interpolated_shapes(dusty):
    mu = float(np.cos(20.5 / 63 * np.pi / 2))
    shape = 0.5 * (shapes_of(dusty, 0)[-1, 20] + shapes_of(dusty, 0)[-1, 21])
    weight = 0.5 * (dusty.weights[0, 0, -1, 20] + dusty.weights[0, 0, -1, 21])
    only = dusty.weights.copy()
    only[:, [number for number, name in enumerate(dusty.closures) if Strip.of(name).is_weight][1:]] = 0.0
    alone = lamina.Lut(dusty.header, only).evaluate(mu, 0.5, 2.0)
    wanted = weight * moving_lobes.values(shape, mu, 0.5, 2.0) / 0.5
    assert alone == pytest.approx(wanted, rel=2e-3)


def test_equal_bytes_for_any_number_of_threads(lacquered):
    again = lamina.bake(LACQUERED, "preview", basis="moving", threads=3)
    assert again.weights.tobytes() == lacquered.weights.tobytes()


def test_given_closures_keep_the_layout(lacquered):
    other = Stack([Interface(1.4)], LACQUERED.base)
    again = lamina.bake(other, "preview", basis="moving", closures=lacquered.closures)
    assert again.closures == lacquered.closures
    assert again.report["fit_error"] < 0.05


def test_a_stack_that_fixed_closures_fit_has_no_moving_ones():
    stack = Stack([Interface(1.5)], Lambert(0.5))
    moving, standard = (lamina.bake(stack, "preview", basis=basis) for basis in ("moving", "standard"))
    assert moving.closures == standard.closures and moving.weights.tobytes() == standard.weights.tobytes()


def test_a_thick_layer_that_hides_the_lobes_keeps_fixed_closures():
    """The clean paint has one moving lobe; Cycles would drop the other. Closures for dust need its place."""
    stack = lamina.presets.load("dusty-car-paint")
    moving, standard = (lamina.bake(stack, "preview", basis=basis) for basis in ("moving", "standard"))
    bare = lamina.bake(Stack(stack.layers[1:], stack.base), "preview", basis="moving")
    assert moving.report["fit_error"] <= standard.report["fit_error"]
    number = moving.closures.index("moving:0")
    assert not moving.weights[0, number, 1:].any() and moving.weights[0, number, 0].any()
    assert moving.weights[0, number, 0] == pytest.approx(bare.weights[0, bare.closures.index("moving:0"), 0])
    assert np.all(shapes_of(moving, 0) == shapes_of(bare, 0)[0])


def test_sheets_keep_fixed_closures():
    sheet = Stack([Medium(0.9, 1.0, HenyeyGreenstein(0.8))], None)
    assert not any(map(shaped_lobes.is_shaped, lamina.bake(sheet, "preview", basis="moving").closures))


def test_a_saved_table_is_read_again(lacquered, tmp_path):
    lacquered.save(tmp_path / "gold.npz")
    assert lamina.Lut.load(tmp_path / "gold.npz") == lacquered


def test_a_table_with_a_wrong_shape_is_refused(lacquered, tmp_path):
    def refused(header, weights):
        lamina.Lut(header, weights).save(tmp_path / "wrong.npz")
        with pytest.raises(LutError) as caught:
            lamina.Lut.load(tmp_path / "wrong.npz")
        return str(caught.value)

    weights = lacquered.weights.copy()
    weights[0, lacquered.closures.index("shape/moving:1"), 0, 5, 0] = 1.5
    assert "shape of a closure is out of range" in refused(lacquered.header, weights)
    names = ["diffuse" if name == "shape/moving:0" else name for name in lacquered.closures]
    assert "shape/moving:0" in refused({**lacquered.header, "closures": names}, lacquered.weights)


def test_the_values_of_a_moving_lobe_need_its_shape():
    with pytest.raises(ValueError, match="shape"):
        lobes.by_id("moving:0").evaluate(0.5, 0.5, 0.0)


def test_eevee_gets_a_glossy_closure_of_the_same_albedo(lacquered):
    found = real_time.few_closures(lacquered)
    mirror = lacquered.weights[0, lacquered.closures.index("mirror:0"), 0]
    total = found.texels[0, :, 0, :, :3].sum(axis=0)
    mu = np.cos(np.arange(60) / 63 * np.pi / 2)
    assert total[:60] == pytest.approx(lacquered.reflectance(mu), rel=1e-3)
    assert {"glossy", "mirror"} & {strip.closure for strip in found.strips}
    assert np.all(mirror > 0.0)

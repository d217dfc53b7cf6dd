# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of anisotropic stacks, whose rows are azimuths of the view."""

import numpy as np
import oriented_stacks
import pytest

import lamina
from lamina import ArgumentError, Interface, Lambert, LutError, Medium, PrincipledBase, Stack, StackError
from lamina.baking.bases.choice import largest_size
from lamina.baking.fit.slices import grid_of, slices, solve_rows
from lamina.baking.report.result_curves import result_curves
from lamina.closures import shaped_lobes
from lamina.common.progress import silent
from lamina.solver.core_calls import thread_pool

LACQUERED = oriented_stacks.STACKS["smooth lacquer on brushed metal"]
CROSSED = oriented_stacks.STACKS["crossed"]
ANGLE = 0.6
# Bars for the report of a preview: mean and worst slice; and for slices between texels.
MEAN, WORST, BETWEEN = 0.045, 0.09, 0.1


@pytest.fixture(scope="module")
def lacquered():
    return lamina.bake(LACQUERED, "preview", basis="moving")


def random_points(count, seed):
    rng = np.random.default_rng(seed)
    return (rng.uniform(0.1, 1.0, count), rng.uniform(0.1, 1.0, count), rng.uniform(-np.pi, np.pi, count),
            rng.uniform(0.0, np.pi, count))


@pytest.mark.parametrize("name", ["smooth lacquer on brushed metal", "brushed coat on paint", "crossed"])
def test_slices_are_those_of_the_solver(name):
    """What facets scatter once is exact; the rest is interpolated between beams."""
    stack = oriented_stacks.STACKS[name]
    solved = solve_rows(stack, "preview", 0, silent)
    grid = grid_of(stack, "preview")
    seen = slices(solved, grid, thread_pool(0), silent)["reflection"]
    function, azimuths = solved.functions[0], solved.azimuths
    rng = np.random.default_rng(4)
    cosines = lamina.closures.closure_table.view_cosines()
    row, column, light = (rng.integers(0, count, 150) for count in (len(azimuths.solved), 56, grid.solid_angle.size))
    mu_i, dphi = (one.ravel()[light] for one in np.meshgrid(grid.mu, grid.dphi, indexing="ij"))
    phi_o = azimuths.solved[row] + azimuths.tangent
    exact = function.brdf(cosines[column], mu_i, dphi, phi_o=phi_o) * mu_i[:, None]
    mine = seen.values[0][row, :, column, light]
    assert np.linalg.norm(mine - exact) <= 4e-3 * np.linalg.norm(exact)
    # Narrow ridges of light that facets scatter twice are smoothed
    assert np.abs(mine - exact).max() <= 8e-3 * exact.max()
    flux = function.reflectance(cosines[column], phi=phi_o, parts=True)[0]
    assert seen.albedo[0][row, :, column] == pytest.approx(flux, rel=2e-3)


def test_the_report_keeps_the_bars(lacquered):
    assert lacquered.report["fit_error"] <= MEAN
    assert lacquered.report["worst_slice"]["error"] <= WORST
    assert 0.0 <= lacquered.report["worst_slice"]["phi_o"] <= np.pi
    assert lacquered.report["albedo_error"] <= 1e-6
    assert any(map(shaped_lobes.is_oriented, lacquered.closures))


def test_the_table_is_the_stack_between_its_texels(lacquered):
    exact = lamina.solve(LACQUERED, "preview")
    rng = np.random.default_rng(6)
    mu_o, phi_o = rng.uniform(0.1, 1.0, 12), rng.uniform(0.0, 2.0 * np.pi, 12)
    albedo = lacquered.reflectance(mu_o, phi_o=phi_o)
    # At texels it is exact; the rows of a preview are 15 degrees apart
    assert albedo == pytest.approx(np.broadcast_to(exact.reflectance(mu_o, phi=phi_o), albedo.shape), rel=1e-2)
    grid = grid_of(LACQUERED, "preview")
    mu_i, dphi = np.meshgrid(grid.mu[::3], grid.dphi[::3], indexing="ij")
    weight = grid.solid_angle.reshape(len(grid.mu), -1)[::3, ::3]
    for mu, phi in zip(mu_o[:6], phi_o[:6], strict=True):
        wanted = exact.brdf(mu, mu_i, dphi, phi_o=phi) * mu_i[..., None]
        mine = lacquered.evaluate(mu, mu_i, dphi, phi_o=phi)[..., :1] * mu_i[..., None]
        error = np.sqrt((weight * (mine - wanted)[..., 0] ** 2).sum() / (weight * wanted[..., 0] ** 2).sum())
        assert error <= BETWEEN, (mu, phi)


def test_a_comparison_measures_the_errors_of_the_report(lacquered):
    compared = lacquered.compare()
    assert compared.mean == pytest.approx(lacquered.report["fit_error"], rel=1e-4)
    assert compared.worst["phi_o"] == lacquered.report["worst_slice"]["phi_o"]
    with pytest.raises(ArgumentError, match="angles of those of the table"):
        lacquered.compare(oriented_stacks.turned(LACQUERED, ANGLE))


def test_curves_of_the_result_are_those_of_a_view_along_the_tangent(lacquered):
    curves = result_curves(LACQUERED, lacquered)
    exact, fitted = np.array(curves["exact"]), np.array(curves["fitted"])
    assert np.all(np.linalg.norm(fitted - exact, axis=1) <= WORST * np.linalg.norm(exact, axis=1))
    mu, light = np.cos(np.radians(curves["views"][1])), curves["lights"].index(40.5)
    value = lamina.solve(LACQUERED, "preview").brdf(mu, np.cos(np.radians(40.5)), 0.0, phi_o=0.0)[0]
    assert exact[1, light] == pytest.approx(value * np.cos(np.radians(40.5)), rel=1e-3)


def test_an_image_fits_into_the_largest_size(lacquered):
    height, width, _ = lacquered.image().shape
    assert (height, width) <= largest_size(LACQUERED, "moving")


def test_the_table_has_the_symmetries_of_the_stack(lacquered):
    mu_o, mu_i, dphi, phi_o = random_points(60, 3)
    one = lacquered.evaluate(mu_o, mu_i, dphi, phi_o=phi_o)
    assert lacquered.evaluate(mu_o, mu_i, dphi, phi_o=phi_o + np.pi) == pytest.approx(one, rel=1e-5)
    assert lacquered.evaluate(mu_o, mu_i, -dphi, phi_o=-phi_o) == pytest.approx(one, rel=1e-5)


def test_an_angle_turns_the_table(lacquered):
    turned = lamina.bake(oriented_stacks.turned(LACQUERED, ANGLE), "preview", basis="moving")
    assert turned.header["axes"]["azimuth"]["tangent"] == pytest.approx(ANGLE)
    mu_o, mu_i, dphi, phi_o = random_points(30, 5)
    one = lacquered.evaluate(mu_o, mu_i, dphi, phi_o=phi_o)
    assert turned.evaluate(mu_o, mu_i, dphi, phi_o=phi_o + ANGLE) == pytest.approx(one, rel=1e-5)


def test_tangents_that_cross_have_rows_for_half_a_turn():
    lut = lamina.bake(CROSSED, "preview", basis="moving")
    assert lut.report["fit_error"] <= MEAN
    assert lut.report["worst_slice"]["error"] <= WORST
    assert np.array_equal(lut.weights[:, :, 0], lut.weights[:, :, -1])
    assert not np.allclose(lut.weights[:, :, 1], lut.weights[:, :, -2], rtol=1e-3)


def test_any_number_of_threads_gives_the_same_bytes(lacquered):
    again = lamina.bake(LACQUERED, "preview", basis="moving", threads=1)
    assert again.weights.tobytes() == lacquered.weights.tobytes()


def test_a_table_survives_its_file(lacquered, tmp_path):
    lacquered.save(tmp_path / "brushed.npz")
    assert lamina.Lut.load(tmp_path / "brushed.npz") == lacquered


def test_a_damaged_table_is_refused(lacquered, tmp_path):
    weights = lacquered.weights.copy()
    weights[0, lacquered.closures.index("shape/oriented:0"), 2, 5, 1] = 1.5
    names = [name for name in lacquered.closures if name != "tilt/oriented:0"]
    missing = lamina.Lut({**lacquered.header, "closures": names}, lacquered.weights)
    for lut, words in ((lamina.Lut(lacquered.header, weights), "out of range"), (missing, "tilt/oriented:0")):
        lut.save(tmp_path / "damaged.npz")
        with pytest.raises(LutError, match=words):
            lamina.Lut.load(tmp_path / "damaged.npz")


COAT = Interface(1.5, 0.1, alpha_v=0.3)


@pytest.mark.parametrize(("stack", "words"), [
    (oriented_stacks.STACKS["sheet"], "base = null"),
    (Stack([COAT, Medium(0.9, 1.0, varying=True)], Lambert(0.5)), r"layers\[1\]: must be the top layer"),
    (Stack([Medium(albedo=(0.4, 0.9), tau=1.0, varying=True)], oriented_stacks.metal(0.1, 0.3)), "channels = 2"),
    (Stack([COAT], Lambert(0.5, textured=True)), "no input"),
    (Stack([COAT], PrincipledBase()), "no input"),
])
def test_stacks_without_a_table_are_refused(stack, words):
    with pytest.raises(StackError, match=words):
        lamina.bake(stack, "preview", basis="moving")


def test_bases_of_closures_that_do_not_move_are_refused():
    with pytest.raises(ArgumentError, match=r"Blender 5\.0"):
        lamina.bake(LACQUERED, "preview")


def test_facets_that_are_too_narrow_are_refused():
    narrow = Stack([], oriented_stacks.metal(0.02, 0.3))
    with pytest.raises(lamina.SolveError, match="too narrow"):
        lamina.bake(narrow, "preview", basis="moving")

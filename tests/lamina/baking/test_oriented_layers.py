# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of a layer of varying thickness on anisotropic facets, with rows for thicknesses and azimuths."""

import numpy as np
import oriented_stacks
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Medium, Stack
from lamina.baking.bases.choice import largest_size
from lamina.baking.fit.slices import SOLVED_ROWS_OF_AZIMUTH, grid_of, slices, solve_rows
from lamina.baking.table.real_time import few_closures
from lamina.closures.closure_table import view_cosines
from lamina.common.progress import silent
from lamina.kinds.table import AZIMUTH_ROWS, TAU_ROWS_OF_AZIMUTH
from lamina.solver.core_calls import thread_pool

DUST = Medium((0.75, 0.68, 0.58), 1.0, HenyeyGreenstein(0.6), varying=True)
DUSTY = Stack([DUST], oriented_stacks.metal(0.08, 0.3, angle=0.4))
CROSSED = Stack([DUST, *oriented_stacks.STACKS["crossed"].layers], oriented_stacks.STACKS["crossed"].base)
# The bars of dust on brushed metal: mean and worst slice.
MEAN, WORST = 0.08, 0.16


@pytest.fixture(scope="module")
def dusty():
    return lamina.bake(DUSTY, "preview", basis="moving")


@pytest.mark.parametrize("stack", [DUSTY, CROSSED])
def test_slices_are_those_of_the_solver(stack):
    """Each thickness, against a solve of its own and single points of the scattering function."""
    solved, grid = solve_rows(stack, "preview", 0, silent), grid_of(stack, "preview")
    seen = slices(solved, grid, thread_pool(0), silent)["reflection"]
    azimuths, rng = solved.azimuths, np.random.default_rng(4)
    turn, column, light = (rng.integers(0, count, 60) for count in (len(azimuths.solved), 56, grid.solid_angle.size))
    mu_i, dphi = (one.ravel()[light] for one in np.meshgrid(grid.mu, grid.dphi, indexing="ij"))
    mu_o, phi_o = view_cosines()[column], azimuths.solved[turn] + azimuths.tangent
    for number in (0, 3, 7):
        alone = Stack([Medium(DUST.albedo, solved.tau[number], DUST.phase), *stack.layers[1:]], stack.base)
        function, row = lamina.solve(alone, "preview"), turn * len(solved.rows) + number
        exact = function.brdf(mu_o, mu_i, dphi, phi_o=phi_o) * mu_i[:, None]
        assert np.linalg.norm(seen.values[0][row, :, column, light] - exact) <= 5e-3 * np.linalg.norm(exact)
        flux = function.reflectance(mu_o, phi=phi_o, parts=True)[0]
        assert seen.albedo[0][row, :, column] == pytest.approx(flux, rel=2e-3)


def test_the_report_keeps_the_bars_on_both_axes(dusty):
    report, axes = dusty.report, dusty.header["axes"]
    assert axes["azimuth"]["count"] * axes["tau"]["count"] == dusty.weights.shape[2]
    assert (axes["azimuth"]["count"], axes["tau"]["count"]) == (AZIMUTH_ROWS["preview"], TAU_ROWS_OF_AZIMUTH)
    assert report["fit_error"] <= MEAN
    assert report["worst_slice"]["error"] <= WORST
    assert report["worst_slice"]["tau"] in np.array(axes["tau"]["values"])[[*SOLVED_ROWS_OF_AZIMUTH, -1]]
    assert 0.4 <= report["worst_slice"]["phi_o"] <= 0.4 + np.pi
    assert max(report["row_errors"]["worst"]) == pytest.approx(report["worst_slice"]["error"], abs=1e-6)
    assert report["albedo_error"] <= 1e-6


def test_without_dust_it_is_the_clean_metal(dusty):
    clean = lamina.bake(Stack([], DUSTY.base), "preview", basis="moving")
    assert dusty.report["row_errors"]["mean"][0] <= clean.report["fit_error"] + 5e-3
    mu_o, phi_o = np.meshgrid(view_cosines()[:60:9], np.radians([0.0, 15.0, 45.0, 75.0, 90.0]) + 0.4)
    albedo = clean.reflectance(mu_o, phi_o=phi_o)
    assert dusty.reflectance(mu_o, tau=0.0, phi_o=phi_o) == pytest.approx(albedo, rel=1e-5)


def test_the_table_is_the_stack_between_its_texels(dusty):
    """Also at thicknesses that were not solved."""
    exact, grid = lamina.solve(DUSTY, "preview"), grid_of(DUSTY, "preview")
    mu_i, dphi = np.meshgrid(grid.mu[::2], grid.dphi[::2], indexing="ij")
    weight = grid.solid_angle.reshape(len(grid.mu), -1)[::2, ::2]
    rng = np.random.default_rng(6)
    axis = dusty.header["axes"]["tau"]["values"]
    for tau in (axis[3], 0.5 * (axis[4] + axis[5]), axis[8], 0.8):
        function = exact.with_thickness(0, tau)
        mu_o, phi_o = rng.uniform(0.2, 1.0, 5), rng.uniform(0.0, 2.0 * np.pi, 5)
        albedo = dusty.reflectance(mu_o, phi_o=phi_o, tau=tau)
        assert albedo == pytest.approx(np.broadcast_to(function.reflectance(mu_o, phi=phi_o), albedo.shape), rel=1.5e-2)
        for mu, phi in zip(mu_o, phi_o, strict=True):
            wanted = (function.brdf(mu, mu_i, dphi, phi_o=phi) * mu_i[..., None])[..., 1]
            mine = (dusty.evaluate(mu, mu_i, dphi, phi_o=phi, tau=tau) * mu_i[..., None])[..., 1]
            error = np.sqrt((weight * (mine - wanted) ** 2).sum() / (weight * wanted**2).sum())
            assert error <= WORST, (tau, mu, phi)


def test_a_comparison_measures_the_errors_of_the_report(dusty):
    compared = dusty.compare()
    assert compared.mean == pytest.approx(dusty.report["fit_error"], rel=1e-3)
    assert compared.worst["tau"] == dusty.report["worst_slice"]["tau"]
    assert compared.worst["phi_o"] == dusty.report["worst_slice"]["phi_o"]


def test_tangents_that_cross_have_rows_for_half_a_turn():
    lut = lamina.bake(CROSSED, "preview", basis="moving")
    assert lut.report["fit_error"] <= MEAN
    assert lut.report["worst_slice"]["error"] <= WORST
    rows = TAU_ROWS_OF_AZIMUTH
    assert np.array_equal(lut.weights[:, :, :rows], lut.weights[:, :, -rows:])


def test_given_closures_keep_the_layout_while_a_slider_moves(dusty):
    other = Stack([Medium((0.6, 0.6, 0.6), 0.8, DUST.phase, varying=True)], DUSTY.base)
    again = lamina.bake(other, "preview", basis="moving", closures=dusty.closures, row_stride=8)
    assert again.closures == dusty.closures
    assert again.weights.shape == dusty.weights.shape
    assert again.report["fit_error"] <= MEAN


def test_the_file_the_image_and_the_closures_for_eevee(dusty, tmp_path):
    dusty.save(tmp_path / "dusty.npz")
    assert lamina.Lut.load(tmp_path / "dusty.npz") == dusty
    height, width, _ = dusty.image().shape
    assert (height, width) <= largest_size(DUSTY, "moving")
    shown = few_closures(dusty)
    assert shown.texels.shape[2] == dusty.weights.shape[2]
    # All closures together keep the albedo, at every thickness and azimuth
    axes = dusty.header["axes"]
    column, mu_o = 20, view_cosines()[20]
    for turn, row in ((0, 0), (3, 5), (6, 16)):
        total = shown.texels[0, :, turn * axes["tau"]["count"] + row, column, :3].sum(axis=0)
        phi_o = 0.4 + np.pi * turn / (axes["azimuth"]["count"] - 1)
        assert total == pytest.approx(dusty.reflectance(mu_o, phi_o=phi_o, tau=axes["tau"]["values"][row]), rel=1e-3)


def test_a_painted_film_has_tables_with_and_without_it():
    stack = Stack([Interface(1.47, 0.3, varying=True)], DUSTY.base)
    lut = lamina.bake(stack, "preview", basis="moving")
    for one in (lut, lut.uncovered):
        assert one.report["worst_slice"]["error"] <= WORST
        assert one.header["axes"]["azimuth"]["tangent"] == pytest.approx(0.4)
    mu_o, phi_o = np.array([0.9, 0.5, 0.3]), np.radians([0.0, 15.0, 45.0]) + 0.4
    for share, of in ((0.0, Stack([], DUSTY.base)), (1.0, stack)):
        exact = lamina.solve(of, "preview").reflectance(mu_o, phi=phi_o)
        albedo = lut.reflectance(mu_o, phi_o=phi_o, coverage=share)
        assert albedo == pytest.approx(np.broadcast_to(exact, albedo.shape), rel=5e-3)


def test_a_dataset_has_both_axes(dusty):
    pytest.importorskip("xarray")
    data, axes = dusty.to_xarray(), dusty.header["axes"]
    assert dict(data.weights.sizes)["azimuth"] == axes["azimuth"]["count"]
    assert data.azimuth.values[0] == pytest.approx(0.4)
    closure, turn, row, column = 4, 5, 3, 20
    texel = data.weights.isel(side=0, closure=closure, roughness=0, azimuth=turn, tau=row, view_angle=column)
    assert np.array_equal(texel, dusty.weights[0, closure, turn * axes["tau"]["count"] + row, column])
    worst = data.slice_errors.sel(view_angle=data.view_angle[data.mu_o >= 0.05]).max()
    assert float(worst) == pytest.approx(dusty.report["worst_slice"]["error"], abs=1e-5)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes for live editing: given closures, interpolated rows; and the one pass against single lookups."""

import numpy as np
import pytest

import lamina
from lamina import _core
from lamina.baking.fit.slices import slices, solve_rows
from lamina.closures.closure_table import light_grid, view_cosines
from lamina.solver.core_calls import tolerance_of

HG = lamina.HenyeyGreenstein
COVERED = lamina.Stack(
    [lamina.Medium(albedo=[0.95, 0.9, 0.8], tau=0.3, phase=HG(0.6)), lamina.Medium(albedo=0.7, tau=[1.0, 2.0, 1.0])],
    base=lamina.Lambert([0.5, 0.3, 0.0]))
SHEET = lamina.Stack([lamina.Medium(albedo=[0.95, 0.9, 0.8], tau=0.5, phase=HG(0.7)),
                      lamina.Medium(albedo=1.0, tau=1.5, phase=lamina.Rayleigh())])
ENDLESS = lamina.Stack([lamina.Medium(albedo=0.9, tau=0.2, phase=HG(0.5))],
                       base=lamina.HalfSpace(albedo=0.99, phase=HG(-0.3)))
ALONE = lamina.Stack([lamina.Medium(albedo=0.9, tau=1e-3, phase=HG(0.8))])
FAINT = lamina.Stack([lamina.Medium(albedo=1.0, tau=2e-5, phase=HG(0.6)), lamina.Medium(albedo=0.9, tau=0.02)])
VEIL = lamina.Stack([lamina.Medium(albedo=1.0, tau=1e-4, phase=HG(-0.4)), lamina.Medium(albedo=1.0, tau=2.0)],
                    base=lamina.Lambert(1.0))
DEEP = lamina.Stack([], base=lamina.HalfSpace(albedo=1.0, phase=lamina.Rayleigh()))
VARYING = lamina.Stack([lamina.Medium(albedo=[0.9, 0.8, 0.6], tau=2.0, phase=HG(0.6), varying=True)],
                       base=lamina.Lambert([0.5, 0.3, 0.1]))


COATED = lamina.Stack([lamina.Medium(albedo=0.9, tau=0.3), lamina.Interface(1.5),
                       lamina.Medium(albedo=[0.9, 0.5, 0.2], tau=1.0, phase=HG(0.6))], lamina.Lambert(0.4))
ROUGH = lamina.Stack([lamina.Interface(1.5, 0.3), lamina.Medium(albedo=0.9, tau=1.0)],
                     lamina.Conductor([0.2, 0.9, 1.3], [3.9, 2.4, 2.0], 0.2))
PLATE = lamina.Stack([lamina.Interface(1.4, 0.4), lamina.Medium(albedo=0.9, tau=1.0), lamina.Interface(1.0)])

# Slices of a table hold lobes seen in lobes by the nodes' polynomials; single values integrate them over rays.
LOBES_MEET = (ROUGH, PLATE)
STACKS = {"covered": COVERED, "sheet": SHEET, "endless": ENDLESS, "alone": ALONE, "faint": FAINT, "veil": VEIL,
          "deep": DEEP, "coated": COATED, "rough": ROUGH, "plate": PLATE}


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_one_pass_equals_single_look_ups(stack):
    grid, mu = light_grid(8, 6), view_cosines()
    solved = solve_rows(stack, "preview", 1, lambda *_: None)
    seen = slices(solved, grid, _core.ThreadPool(1), lambda *_: None)
    function = solved.functions[0]
    for index, side in enumerate(solved.sides):
        other = {"top": "bottom", "bottom": "top"}[side]
        values = function.grid("reflect", mu, grid.mu, grid.dphi, side)
        expected = {"reflection": (values, function.reflectance(mu, side))}
        if solved.is_sheet:
            diffuse, direct = function.transmittance(mu, side, parts=True)
            expected["transmission"] = (function.grid("transmit", mu, grid.mu, grid.dphi, other), diffuse)
            np.testing.assert_allclose(seen["transmission"].direct[index, 0], direct.T, rtol=1e-12, atol=1e-15)
        assert set(seen) == set(expected)
        for kind, (values, albedo) in expected.items():
            weighted = np.moveaxis(values * grid.mu[:, None, None], -1, 0).reshape(stack.channels, len(mu), -1)
            if stack in LOBES_MEET:
                off = np.linalg.norm(seen[kind].values[index, 0] - weighted)
                assert off < tolerance_of("preview") * np.linalg.norm(weighted)
            else:
                np.testing.assert_allclose(seen[kind].values[index, 0], weighted, rtol=1e-9, atol=1e-14)
            # Specular reflection by smooth boundaries is returned separately.
            found = seen[kind].albedo[index, 0] + (seen[kind].direct[index, 0] if kind == "reflection" else 0.0)
            np.testing.assert_allclose(found, albedo.T, rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("stack", [
    lamina.Stack([lamina.Medium(albedo=1.0, tau=0.5, phase=HG(0.7)), lamina.Medium(albedo=1.0, tau=3.0)]),
    lamina.Stack([lamina.Medium(albedo=1.0, tau=1e-3, phase=HG(0.6))]),
    VEIL,
], ids=["sheet", "thin", "veil"])
def test_albedos_of_what_absorbs_nothing_sum_to_one(stack):
    solved = solve_rows(stack, "final", 1, lambda *_: None)
    seen = slices(solved, light_grid(8, 6), _core.ThreadPool(1), lambda *_: None)
    total = sum(part.albedo + part.direct for part in seen.values())
    assert np.abs(total[..., view_cosines() >= 0.01] - 1.0).max() < 1e-6


@pytest.mark.parametrize("stack", [COVERED, SHEET, VARYING], ids=["covered", "sheet", "varying"])
def test_given_closures_make_the_same_table(stack):
    chosen = lamina.bake(stack, "preview")
    given = lamina.bake(stack, "preview", closures=chosen.closures)
    assert given.closures == chosen.closures and given.header["axes"] == chosen.header["axes"]
    scale = chosen.weights.max()
    # Two closures that are nearly the same may share their weight otherwise by rounding.
    assert np.mean(np.abs(given.weights - chosen.weights)) < 1e-4 * scale
    assert given.report["fit_error"] == pytest.approx(chosen.report["fit_error"], rel=1e-9)


def test_given_closures_keep_their_order_over_edits():
    ids = lamina.bake(COVERED, "preview").closures[::-1]
    edited = lamina.Stack([lamina.Medium(albedo=0.2, tau=3.0, phase=HG(-0.5))], base=lamina.Black())
    lut = lamina.bake(edited, "preview", closures=ids)
    assert lut.closures == ids and lut.report["albedo_error"] < 1e-6


def test_a_kind_that_is_not_given_is_chosen():
    ids = ["diffuse"]
    lut = lamina.bake(SHEET, "preview", closures=ids)
    assert lut.closures[:1] == ids and len(lut.closures) > 2
    assert lut.closures[-1] == "transparent"
    back = lamina.bake(COVERED, "preview", closures=lut.closures)
    assert back.closures == ids


def test_closures_that_leave_views_of_a_sheet_dark_are_chosen_anew():
    tilted = "toon_075_025_tiltm60"
    assert lamina.bake(COVERED, "preview", closures=["diffuse", tilted]).closures == ["diffuse", tilted]
    assert lamina.bake(COVERED, "preview", closures=[tilted]).closures == [tilted]
    lut = lamina.bake(SHEET, "preview", closures=[tilted])
    assert lut.closures == lamina.bake(SHEET, "preview").closures


@pytest.mark.parametrize("closures, sentence", [
    (["nonsense"], "'nonsense' is not in the dictionary"), (["diffuse", "diffuse"], "given twice"),
])
def test_bad_closures_are_refused(closures, sentence):
    with pytest.raises(ValueError, match=sentence):
        lamina.bake(COVERED, "preview", closures=closures)


def test_interpolated_rows():
    whole = lamina.bake(VARYING, "preview")
    coarse = lamina.bake(VARYING, "preview", closures=whole.closures, row_stride=4)
    assert coarse.weights.shape == whole.weights.shape and coarse.header["axes"] == whole.header["axes"]
    assert coarse.report["tau_rows_solved"] == 9 and whole.report["tau_rows_solved"] == 33
    assert np.allclose(coarse.weights[:, :, ::4], whole.weights[:, :, ::4], atol=1e-5 * whole.weights.max())
    assert np.abs(coarse.weights - whole.weights).mean() < 0.03 * whole.weights.mean()
    # Between solved rows the table is theirs, mixed.
    middle = 0.5 * (coarse.weights[:, :, 4:-3:4] + coarse.weights[:, :, 8::4])
    assert np.allclose(coarse.weights[:, :, 6::4], middle, rtol=1e-5, atol=1e-7)
    with pytest.raises(ValueError, match="row_stride = 0"):
        lamina.bake(VARYING, "preview", row_stride=0)


@pytest.mark.parametrize("stack", [COVERED, SHEET, VARYING], ids=["covered", "sheet", "varying"])
def test_threads_change_nothing(stack):
    one, two = (lamina.bake(stack, "preview", threads=n) for n in (1, 2))
    assert one.weights.tobytes() == two.weights.tobytes() and one.header == two.header


def test_fewer_nodes_are_a_quick_look():
    peaked = lamina.Stack([lamina.Medium(albedo=0.9, tau=1.0, phase=HG(0.95))], base=lamina.Lambert(0.5))
    whole = lamina.bake(peaked, "preview")
    quick = lamina.bake(peaked, "preview", closures=whole.closures, nodes=32)
    assert quick.report["solver"]["nodes"] == 32 < whole.report["solver"]["nodes"]
    assert np.abs(quick.weights - whole.weights).mean() < 0.03 * whole.weights.mean()
    with pytest.raises(ValueError, match="nodes = 4"):
        lamina.bake(peaked, "preview", nodes=4)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: pure, cancellable, and with a report that agrees with independent measurements."""

import math

import numpy as np
import pytest

import lamina
from lamina import Black, HalfSpace, HenyeyGreenstein, Lambert, Medium, Rayleigh, Stack, _core, lobes

STACKS = {
    "slab": Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.75))]),
    "rgb on Lambert": Stack([Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=HenyeyGreenstein(0.6))],
                            base=Lambert([0.5, 0.3, 0.1])),
    "two-sided": Stack([Medium(albedo=0.95, tau=0.5, phase=HenyeyGreenstein(-0.4)), Medium(albedo=0.5, tau=1.0)]),
    "half-space": Stack(base=HalfSpace(0.95, HenyeyGreenstein(0.6))),
}
VARYING = Stack([Medium(albedo=[0.9, 0.8, 0.6], tau=[3.0, 1.5, 0.0], varying=True)], base=Lambert(0.3))
STATED = 0.05
# Hair lobes have poles along their tangents, thin spikes of which a finer grid sees more: .1692, .1726 and .1741 for
# the slab on the bake's grid, on 56 x 48 and on 160 x 160 directions.
THROUGH_GRIDS = 0.04


def cosines():
    return np.maximum(np.cos(np.linspace(0.0, math.pi / 2, 64)), 6e-3)


@pytest.fixture(scope="module", params=STACKS)
def baked(request):
    return STACKS[request.param], lamina.bake(STACKS[request.param], "final")


def measured(stack, lut, kind, side, cosine_count=56, azimuth_count=48):
    """(relative L2 error, albedo error), each [column, channel], on a light grid of our own, finer than the bake's."""
    x, wx = np.polynomial.legendre.leggauss(cosine_count)
    y, wy = np.polynomial.legendre.leggauss(azimuth_count)
    mu, dphi = 0.5 * (x + 1.0), 0.5 * math.pi * (y + 1.0)
    weight = np.outer(0.5 * wx, math.pi * wy)[..., None]
    solved, mu_o = lamina.solve(stack), cosines()
    sides = lut.header["sides"]
    other = {"top": "bottom", "bottom": "top"}[side]
    path, source = ("reflect", side) if kind == "reflection" else ("transmit", other)
    exact = solved.grid(path, mu_o, mu, dphi, side=source) * mu[:, None, None]
    fitted = np.zeros((*exact.shape[:3], 3))
    for index, name in enumerate(lut.closures):
        if name != "transparent" and lobes.by_id(name).side == kind:
            shape = lobes.by_id(name).evaluate(mu_o[:, None, None], mu[:, None], dphi)
            fitted += lut.weights[sides.index(side), index, 0][:, None, None, :] * shape[..., None]
    error2 = ((fitted - exact) ** 2 * weight).sum(axis=(1, 2)) / (exact**2 * weight).sum(axis=(1, 2))
    albedo = solved.reflectance(mu_o, side) if path == "reflect" else solved.transmittance(mu_o, side, parts=True)[0]
    fine = (fitted * weight).sum(axis=(1, 2))
    return np.sqrt(error2), np.abs(fine / albedo - 1.0)


def test_report_is_what_an_outsider_measures(baked):
    stack, lut = baked
    stated = cosines() >= STATED
    reflection = [measured(stack, lut, "reflection", side) for side in lut.header["sides"]]
    errors = np.array([e[stated] for e, _ in reflection])
    assert lut.report["fit_error"] == pytest.approx(errors.mean(), rel=0.01)
    assert lut.report["worst_slice"]["error"] == pytest.approx(errors.max(), rel=0.01)
    worst = lut.report["worst_slice"]
    column = int(np.argmin(np.abs(cosines() - worst["mu_o"])))
    at = reflection[lut.header["sides"].index(worst["side"])][0][column, worst["channel"]]
    assert at == pytest.approx(worst["error"], rel=0.01)
    if stack.base is None:
        through = np.array([measured(stack, lut, "transmission", side)[0] for side in lut.header["sides"]])
        assert lut.report["fit_error_transmission"] == pytest.approx(np.mean(through[:, stated]), rel=THROUGH_GRIDS)
        worst = lut.report["worst_slice_transmission"]
        assert worst["error"] == pytest.approx(through[:, stated].max(), rel=THROUGH_GRIDS)
        column = int(np.argmin(np.abs(cosines() - worst["mu_o"])))
        at = through[lut.header["sides"].index(worst["side"]), column, worst["channel"]]
        assert at == pytest.approx(worst["error"], rel=THROUGH_GRIDS)
    else:
        assert lut.report["fit_error_transmission"] is None and lut.report["worst_slice_transmission"] is None


def test_albedos_are_exact(baked):
    """Within .05 %, integrated by us where closures have edges on a grid of 300 x 240."""
    stack, lut = baked
    x, wx = np.polynomial.legendre.leggauss(300)
    mu, dphi = 0.5 * (x + 1.0), (np.arange(240) + 0.5) * math.pi / 240
    mu_o, exact = cosines(), lamina.solve(stack)
    for number, side in enumerate(lut.header["sides"]):
        reached = np.zeros((64, 3))
        for index, name in enumerate(lut.closures):
            if name != "transparent" and lobes.by_id(name).side == "reflection":
                for column in range(0, 60):
                    shape = lobes.by_id(name).evaluate(mu_o[column], mu[:, None], dphi)
                    albedo = math.pi * wx @ shape.mean(axis=1)
                    reached[column] += lut.weights[number, index, 0, column] * albedo
        truth = exact.reflectance(mu_o, side)
        error = np.abs(reached / truth - 1.0)[:60].max()
        assert error < 5e-4
    assert lut.report["albedo_error"] < 5e-4
    assert 0.0 <= lut.report["energy_error"] < 1e-6


def test_transparent_is_the_direct_light():
    lut = lamina.bake(STACKS["slab"], "preview")
    assert lut.closures[-1] == "transparent"
    expected = np.exp(-2.0 / cosines())
    assert lut.weights[0, -1, 0, :, 1] == pytest.approx(expected, rel=1e-6, abs=1e-38)


@pytest.mark.parametrize("stack", [STACKS["two-sided"], VARYING], ids=["two-sided", "varying"])
def test_the_same_bytes_on_any_number_of_threads(stack, tmp_path):
    for threads in (1, 2):
        lamina.bake(stack, "preview", threads=threads).save(tmp_path / f"{threads}.npz")
    assert (tmp_path / "1.npz").read_bytes() == (tmp_path / "2.npz").read_bytes()


def test_names_do_not_matter():
    one, other = (Stack([Medium(albedo=0.5, tau=1.0, name=n)], Black()) for n in ("dust", "snow"))
    assert lamina.bake(one, "preview").weights.tobytes() == lamina.bake(other, "preview").weights.tobytes()


def test_equal_channels_are_one_channel():
    grey = lamina.bake(Stack([Medium(albedo=0.8, tau=1.0, phase=Rayleigh())]), "preview")
    rgb = lamina.bake(Stack([Medium(albedo=[0.8] * 3, tau=1.0, phase=Rayleigh())]), "preview")
    assert grey.closures == rgb.closures
    assert np.array_equal(grey.weights, rgb.weights)
    assert np.array_equal(grey.weights[..., 0], grey.weights[..., 2])


@pytest.mark.parametrize(("stack", "fewest"), [(VARYING, 40), (STACKS["slab"], 6)], ids=["varying", "sheet"])
def test_progress_is_monotone_and_ends_at_1(stack, fewest):
    steps = []
    lamina.bake(stack, "preview", progress=lambda fraction, text: steps.append((fraction, text)))
    fractions = [fraction for fraction, _ in steps]
    assert fractions[0] == 0.0 and fractions[-1] == 1.0 and len(steps) > fewest
    assert all(a <= b for a, b in zip(fractions, fractions[1:], strict=False))
    assert all(isinstance(text, str) and text for _, text in steps)


def test_progress_moves_with_the_rows_that_are_evaluated_and_fitted(monkeypatch):
    """Between two calls of `progress` at most four rows are evaluated, and closures are fitted to at most four."""
    rows, fitted, fractions = [0], [0], []

    def evaluate(solutions, *rest, original=_core.slices):
        rows[-1] += len(solutions)
        return original(solutions, *rest)

    def fit(table, targets, chosen, pool, original=_core.ClosureTable.fit):
        fitted[-1] += len(targets)
        return original(table, targets, chosen, pool)

    def progress(fraction, _text):
        fractions.append(fraction)
        rows.append(0)
        fitted.append(0)

    monkeypatch.setattr(_core, "slices", evaluate)
    monkeypatch.setattr(_core.ClosureTable, "fit", fit)
    lamina.bake(VARYING, "final", progress=progress, row_stride=1)
    views, channels = 64, VARYING.channels
    assert sum(fitted) > 33 * channels * views and sum(rows) > 33 * channels
    assert max(rows) <= 4 * channels and max(fitted) <= 4 * channels * views
    assert max(b - a for a, b in zip(fractions, fractions[1:], strict=False)) < 0.1


def test_cancelling_at_any_step():
    asked = []
    lamina.bake(VARYING, "preview", cancel=lambda: asked.append(1) and False)
    for step in range(0, len(asked), 9):
        left = iter([False] * step)
        with pytest.raises(lamina.Cancelled):
            lamina.bake(VARYING, "preview", cancel=lambda left=left: next(left, True))


def test_an_error_in_progress_reaches_the_caller():
    def fail(fraction, text):
        raise OSError("the screen is gone")

    with pytest.raises(OSError, match="the screen is gone"):
        lamina.bake(STACKS["slab"], "preview", progress=fail)


@pytest.mark.parametrize("stack", [
    Stack([Medium(albedo=0.0, tau=1.0)]),
    Stack([Medium(albedo=1.0, tau=0.0)]),
    Stack(base=Black()),
    Stack([Medium(albedo=0.9, tau=math.inf)]),
    Stack([Medium(albedo=[0.0, 1.0, 0.5], tau=[1.0, 0.0, math.inf])]),
    Stack([Medium(albedo=0.5, tau=0.0, varying=True)], base=Black()),
    Stack([Medium(albedo=1.0, tau=1e-5, phase=HenyeyGreenstein(0.8))]),
    Stack([Medium(albedo=1e-4, tau=1.0)]),
], ids=["no scattering", "nothing", "black", "endless", "mixed", "varying nothing", "thin", "nearly black"])
def test_degenerate_stacks_bake(stack):
    lut = lamina.bake(stack, "preview")
    assert np.all(np.isfinite(lut.weights)) and lut.weights.min() >= 0.0
    assert math.isfinite(lut.report["fit_error"]) and lut.report["albedo_error"] < 5e-4


def test_a_varying_layer_has_a_row_for_each_thickness():
    lut = lamina.bake(VARYING, "preview")
    axis = lut.header["axes"]["tau"]
    assert (axis["count"], axis["layer"], len(axis["values"])) == (33, 0, 33) and axis["values"][-1] == 3.0
    assert lut.weights.shape[2] == 33 and lut.image().shape == (len(lut.closures) * 33, 64, 4)
    # Row 0 is the bare base: a mixture of its albedo in every column, whatever the closures.
    rows = [Stack([Medium(albedo=[0.9, 0.8, 0.6], tau=[s * 3.0, s * 1.5, 0.0])], base=Lambert(0.3)) for s in (0, 1)]
    mu_o = cosines()[:60]
    for row, stack in ((0, rows[0]), (32, rows[1])):
        exact = lamina.solve(stack).reflectance(mu_o)
        x, wx = np.polynomial.legendre.leggauss(200)
        mu, dphi = 0.5 * (x + 1.0), (np.arange(120) + 0.5) * math.pi / 120
        reached = np.zeros_like(exact)
        for index, name in enumerate(lut.closures):
            shape = lobes.by_id(name).evaluate(mu_o[:, None, None], mu[:, None], dphi).mean(axis=2)
            reached += lut.weights[0, index, row, :60] * (math.pi * shape @ wx)[:, None]
        assert reached == pytest.approx(exact, rel=1e-3)


def test_a_stack_is_checked_once(monkeypatch):
    """Facets treated as smooth, the view from below and the clean row are stacks that need no second check."""
    colour = Medium(color=0.5, tau=1.0, phase=HenyeyGreenstein(0.5))
    sheets = [Stack([lamina.Interface(1.5, alpha=0.01), colour, lamina.Interface(1.0)]),
              Stack([Medium(albedo=0.8, tau=1.0, varying=True)], lamina.Conductor(0.2, 3.0, alpha=0.02))]
    before = [lamina.bake(stack, "preview", nodes=8, row_stride=32).weights for stack in sheets]

    def refuse(*_, **__):
        raise AssertionError("checked again")

    monkeypatch.setattr(Stack, "__init__", refuse)
    for stack, weights in zip(sheets, before, strict=True):
        assert np.array_equal(lamina.bake(stack, "preview", nodes=8, row_stride=32).weights, weights)

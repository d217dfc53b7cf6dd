# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked materials on the virtual goniophotometer: six stacks, 5 view and 24 light directions.

The views are Gauss nodes in theta over the columns for which the report states errors (one of them lies on
a column, the others between two), so that means over views are means over slices as the report has them.
The lights are a product Gauss rule in solid angle, so that weighted sums over them are the norms by which
the report measures: `slice_errors` are L2 over the hemisphere of light relative to the slice's norm.
"""

import json
import math
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

import bpy
import goniophotometer
import numpy as np
import pytest

import lamina
from lamina import lobes

ROOT = Path(__file__).resolve().parents[2]
STACKS = json.loads((ROOT / "tests/data/gonio_stacks.json").read_text())
NAMES = ["thin", "thick", "bright", "dark", "forward", "forward, off a row", "backward"]
OTHER = {"top": "bottom", "bottom": "top"}

LAST_COLUMN = 60  # the last of the 64 with a view cosine above .05
ON_ROW, OFF_ROW = 24, 9.5  # rows of thickness at which the varying stack is seen

MIXTURE_RMS = 5e-3
PROMISE_FACTOR = 1.1
# What a weight read between two columns or rows may add to a slice's error, which is stated at both ends.
INTERPOLATION = 3.6e-3
FURNACE_ERROR, FURNACE_SIGMA = 1e-3, 3e-4
FURNACE_PATCHES = 24
PILOT_PATCHES, PILOT_SAMPLES, MOST_SAMPLES = 8, 256, 16384


def _gauss(count, first, last):
    x, w = np.polynomial.legendre.leggauss(count)
    return first + 0.5 * (x + 1.0) * (last - first), 0.5 * w * (last - first)


def hemisphere(cosines, azimuths):
    """(mu_i, dphi, solid angle), each flat. The slices' mirror symmetry leaves dphi in (0, pi)."""
    mu, w = _gauss(cosines, 0.0, 1.0)
    dphi, v = _gauss(azimuths, 0.0, math.pi)
    grid = np.meshgrid(mu, dphi, indexing="ij")
    return grid[0].ravel(), grid[1].ravel(), 2.0 * np.outer(w, v).ravel()


COLUMNS, VIEW_WEIGHTS = _gauss(5, 0.0, LAST_COLUMN)
VIEW_WEIGHTS = VIEW_WEIGHTS / LAST_COLUMN
MU_O = np.cos(COLUMNS / 63 * math.pi / 2)
LIGHTS = hemisphere(4, 6)
DENSE = hemisphere(64, 64)


@dataclass(frozen=True)
class Sample:
    """One baked material, its table, and its exact scattering function at the thickness it shows."""

    name: str
    material: bpy.types.Material
    lut: lamina.Lut
    exact: lamina.ScatteringFunction
    row: float = 0.0

    @property
    def is_sheet(self):
        return self.exact.stack.base is None

    def table_side(self, side):
        """Index of the strips that a face reads: a table of one side serves both faces."""
        return min(["top", "bottom"].index(side), len(self.lut.header["sides"]) - 1)

    def face(self, side):
        """The side of the stack that this face shows."""
        return self.lut.header["sides"][self.table_side(side)]

    def slices(self, kind, side, lights):
        """Exact f * mu_i, shape (views, lights, 3)."""
        mu, dphi, _ = lights
        side = self.face(side)
        if kind == "reflection":
            value = self.exact.brdf(MU_O[:, None], mu, dphi, side=side)
        else:  # what is seen on one side came in on the other
            value = self.exact.btdf(MU_O[:, None], mu, dphi, side=OTHER[side])
        return np.broadcast_to(value * mu[:, None], (len(MU_O), len(mu), 3))

    def mixture(self, kind, side, lights):
        """The fitted closures with weights interpolated as a texture does it, shape (views, lights, 3)."""
        mu, dphi, _ = lights
        weights = self._interpolated(self.lut.weights[self.table_side(side)].astype(float))
        total = np.zeros((len(MU_O), len(mu), 3))
        for name, weight in zip(self.lut.closures, weights, strict=True):
            if name != "transparent" and lobes.by_id(name).side == kind:
                total += weight[:, None, :] * lobes.by_id(name).evaluate(MU_O[:, None], mu, dphi)[..., None]
        return total

    def promised(self, kind, side):
        """The report's slice errors, linear between columns and rows, shape (views, 3)."""
        key = "slice_errors" if kind == "reflection" else "slice_errors_transmission"
        errors = np.array(self.lut.report[key])[self.table_side(side)]  # [row, channel, column]
        errors = self._interpolated(np.moveaxis(errors, 1, 2))
        return np.broadcast_to(errors, (len(MU_O), 3))

    def albedo(self, side):
        """Exact directional albedo, with all light that passes through a sheet; shape (views, 3)."""
        side = self.face(side)
        total = self.exact.reflectance(MU_O, side)
        if self.is_sheet:
            total = total + self.exact.transmittance(MU_O, side)
        return np.broadcast_to(total, (len(MU_O), 3))

    def _interpolated(self, table):
        """table [..., row, column, channel] at the sample's row and the five views."""
        row, column = int(self.row), COLUMNS.astype(int)
        down, right = self.row - row, (COLUMNS - column)[:, None]
        lower = table[..., row, :, :]
        upper = table[..., min(row + 1, table.shape[-3] - 1), :, :]
        rows = lower * (1.0 - down) + upper * down
        return rows[..., column, :] * (1.0 - right) + rows[..., column + 1, :] * right


# --- Materials and readings ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def addon(tmp_path_factory):
    """The add-on of this clone, enabled from an extension repository of our own."""
    import addon_utils  # findable once bpy is there

    running = sys.modules.get("bl_ext.user_default.lamina")
    if getattr(running, "__addon_enabled__", False):
        yield running
        return
    folder = tmp_path_factory.mktemp("extensions")
    shutil.copytree(ROOT / "addon", folder / "lamina", ignore=shutil.ignore_patterns("__pycache__"))
    repositories = bpy.context.preferences.extensions.repos
    repository = repositories.new(name="Goniophotometer", module="gonio", custom_directory=str(folder))
    package = addon_utils.enable("bl_ext.gonio.lamina", default_set=True)
    assert package is not None and package.native.available(), package and package.native.reason()
    yield package
    addon_utils.disable("bl_ext.gonio.lamina", default_set=True)
    if hasattr(bpy.types.Material, "lamina"):  # a class left at interpreter exit hangs Blender
        package.unregister()
    repositories.remove(repository)


@pytest.fixture(scope="module")
def samples(addon):
    made = [sample for data in STACKS for sample in make_samples(addon, data)]
    assert [sample.name for sample in made] == NAMES
    yield made
    for sample in made:
        bpy.data.materials.remove(sample.material)


def make_samples(addon, data):
    """The stack goes through the panel's properties, the bake and the node group, as a user's does."""
    stack = lamina.Stack.from_json({key: value for key, value in data.items() if key != "id"})
    material = bpy.data.materials.new(data["id"])
    material.use_nodes = True
    addon.stack_io.assign_stack(material, stack)
    lut = addon.bake_job.bake_material(material, "final")
    assert lut.header["stack_hash"] == stack.hash
    exact = lamina.solve(stack)
    if stack.varying is None:
        return [Sample(data["id"], material, lut, exact)]
    rows = [(data["id"], material, ON_ROW), (data["id"] + ", off a row", material.copy(), OFF_ROW)]
    return [_at_row(addon, Sample(name, one, lut, exact, row)) for name, one, row in rows]


def _at_row(addon, sample):
    axis, stack = sample.lut.header["axes"]["tau"], sample.exact.stack
    largest = axis["values"][-1]
    share = sample.row / (axis["count"] - 1) * largest / (largest + 0.5)
    thickness = 0.5 * share / (1.0 - share)
    group = sample.lut.header["stack_hash"]
    for node in sample.material.node_tree.nodes:
        if node.type == "GROUP" and node.node_tree.get("lamina_stack_hash") == group:
            node.inputs["Thickness"].default_value = thickness
    taus = [thickness / largest * stack.optics(stack.varying, c)[1] for c in range(stack.channels)]
    exact = sample.exact.with_thickness(stack.varying, taus)
    return Sample(sample.name, sample.material, sample.lut, exact, sample.row)


@pytest.fixture(scope="module")
def readings(samples):
    """{(sample's name, kind, side): f * mu_i as seen in Cycles, shape (views, lights, 3)}."""
    found = {}
    for kind in ("reflection", "transmission"):
        seen = [sample for sample in samples if kind == "reflection" or sample.is_sheet]
        for side in ("top", "bottom"):
            values = _under_the_sun([sample.material for sample in seen], kind, side)
            found |= {(sample.name, kind, side): values[:, :, k] for k, sample in enumerate(seen)}
    return found


def _under_the_sun(materials, kind, side):
    mu, dphi, _ = LIGHTS
    # Every second light stands on the other side of the plane of incidence, where slices are the same.
    dphi = dphi * np.where(np.arange(len(dphi)) % 2, -1.0, 1.0)
    return np.array([
        [
            goniophotometer.measure_many(
                materials, mu_o, *light, samples=1, below=kind == "transmission", backface=side == "bottom"
            )
            for light in zip(mu, dphi, strict=True)
        ]
        for mu_o in MU_O.tolist()
    ])


@pytest.fixture(scope="module")
def furnace(samples):
    """{(sample's name, side): (mean, its standard error), each of shape (views, 3)}; both faces of sheets.

    Each material lies there many times, at other pixels: the spread of its patches tells how far the mean
    can be trusted. A pilot render tells how many samples that takes; where it was too hopeful, twice as many
    are taken, in place of the first ones.
    """
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        # No sun below, so no pixel of a patch is in doubt: read all but those at the seams.
        patch.setattr(goniophotometer, "_READ", slice(1, 7))
        for side in ("top", "bottom"):
            seen = [sample for sample in samples if side == "top" or sample.is_sheet]
            results = np.array([_in_the_furnace(seen, mu_o, side == "bottom") for mu_o in MU_O.tolist()])
            found |= {(sample.name, side): (results[:, k, 0], results[:, k, 1]) for k, sample in enumerate(seen)}
    return found


def _in_the_furnace(seen, mu_o, backface):
    """[(mean, standard error) for each sample], shape (samples, 2, 3)."""
    pilot = _patches([sample.material for sample in seen], PILOT_PATCHES, mu_o, PILOT_SAMPLES, backface)
    spread = (pilot.std(axis=0, ddof=1) / pilot.mean(axis=0)).max(axis=-1)
    # Variance falls at least as 1 / samples. Powers of two, at which Cycles' sequences converge best.
    wanted = PILOT_SAMPLES / FURNACE_PATCHES * (spread / FURNACE_SIGMA) ** 2
    results = []
    for sample, count in zip(seen, wanted, strict=True):
        count = max(2 ** math.ceil(math.log2(count)), 2 * PILOT_SAMPLES)
        while True:
            values = _patches([sample.material], FURNACE_PATCHES, mu_o, count, backface)[:, 0]
            mean, sigma = values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(FURNACE_PATCHES)
            if count >= MOST_SAMPLES or np.all(sigma < FURNACE_SIGMA * mean):
                break
            count *= 2
        results.append((mean, sigma))
    return results


def _patches(materials, repeats, mu_o, count, backface):
    """Furnace readings in one render, shape (repeats, materials, 3)."""
    assert repeats * len(materials) <= 100, "a second render would repeat the first one's random numbers"
    values = goniophotometer.furnace_many(materials * repeats, mu_o, count, backface)
    return values.reshape(repeats, len(materials), 3)


@pytest.fixture(params=NAMES)
def sample(request, samples):
    return samples[NAMES.index(request.param)]


# --- What must hold -----------------------------------------------------------------------------


def seen_parts(sample):
    """(kind, side) of all that a material shows: a sheet is seen from both sides, and through."""
    kinds = ("reflection", "transmission") if sample.is_sheet else ("reflection",)
    return [(kind, side) for kind in kinds for side in ("top", "bottom")]


def norm2(values, lights):
    """Squared L2 norm over solid angle, shape (views, 3)."""
    return np.einsum("vlc,l->vc", values**2, lights[2])


def mixture_rms(sample, readings, kind, side):
    """rms over the light directions of the relative difference, shape (views, 3)."""
    ratio = readings[sample.name, kind, side] / sample.mixture(kind, side, LIGHTS)
    return np.sqrt(np.mean((ratio - 1.0) ** 2, axis=1))


def errors_as_promised(sample, readings, kind, side):
    """(from 24 lights alone, without their sampling error), relative L2 errors of shape (views, 3).

    24 directions see more or less of a closure's edges than the whole hemisphere does. How much, follows
    from the closed forms: the second result replaces their part of the sum over 24 by the sum over a dense
    grid (a control variate), so that only what Cycles adds to the closed forms is sampled by 24.
    """
    exact = sample.slices(kind, side, LIGHTS)
    seen = norm2(readings[sample.name, kind, side] - exact, LIGHTS)
    predicted = norm2(sample.mixture(kind, side, LIGHTS) - exact, LIGHTS)
    dense_exact = sample.slices(kind, side, DENSE)
    dense = norm2(sample.mixture(kind, side, DENSE) - dense_exact, DENSE)
    scale = norm2(dense_exact, DENSE)
    return np.sqrt(seen / norm2(exact, LIGHTS)), np.sqrt(np.maximum(dense + seen - predicted, 0.0) / scale)


def over_views(errors):
    """Mean over slices, from values at the five views, shape (views, 3)."""
    return float(VIEW_WEIGHTS @ errors.mean(axis=1))


def test_five_views_and_24_lights():
    assert len(MU_O) == 5 and MU_O.min() > 0.05
    on_a_column = np.abs(COLUMNS - COLUMNS.round()) < 1e-9
    assert 0 < on_a_column.sum() < 5
    assert len(LIGHTS[0]) == 24
    assert LIGHTS[2].sum() == pytest.approx(2.0 * math.pi) and (LIGHTS[2] @ LIGHTS[0]) == pytest.approx(math.pi)


def test_radiance_is_the_fitted_mixture(sample, readings):
    for kind, side in seen_parts(sample):
        assert mixture_rms(sample, readings, kind, side).max() <= MIXTURE_RMS, (kind, side)


def test_radiance_is_the_exact_function_within_the_promised_error(sample, readings):
    """The mean over slices of what 24 lights see, with no allowance for there being only 24."""
    for kind, side in seen_parts(sample):
        raw, whole = errors_as_promised(sample, readings, kind, side)
        promised = over_views(sample.promised(kind, side))
        assert over_views(raw) <= PROMISE_FACTOR * promised, (kind, side)
        assert over_views(whole) <= PROMISE_FACTOR * promised, (kind, side)


@pytest.mark.parametrize("kind", ["reflection", "transmission"])
def test_the_one_figure_of_the_report_is_kept(sample, readings, kind):
    """`fit_error`, the mean over all slices of a table: for tables of one thickness, where we see them all."""
    figure = sample.lut.report["fit_error" if kind == "reflection" else "fit_error_transmission"]
    sides = [side for part, side in seen_parts(sample) if part == kind]
    if not sides or sample.exact.stack.varying is not None:
        return
    for result in zip(*(errors_as_promised(sample, readings, kind, side) for side in sides), strict=True):
        assert np.mean([over_views(errors) for errors in result]) <= PROMISE_FACTOR * figure


def test_every_view_and_channel_keeps_its_promise(sample, readings):
    for kind, side in seen_parts(sample):
        _, whole = errors_as_promised(sample, readings, kind, side)
        allowed = np.hypot(PROMISE_FACTOR * sample.promised(kind, side), INTERPOLATION)
        assert np.all(whole <= allowed), (kind, side, whole / allowed)


def test_white_furnace_is_the_exact_albedo(sample, furnace):
    """Of a sheet, R + T: what the sky of both sides sends, the direct light included."""
    for side in ("top", "bottom") if sample.is_sheet else ("top",):
        mean, sigma = furnace[sample.name, side]
        exact = sample.albedo(side)
        assert np.all(sigma < FURNACE_SIGMA * exact), "too noisy to say anything"
        assert np.all(np.abs(mean - exact) <= FURNACE_ERROR * exact), (side, mean / exact - 1.0)


def test_a_table_of_one_side_looks_the_same_on_back_faces(sample, readings):
    if len(sample.lut.header["sides"]) == 2:
        top, bottom = (readings[sample.name, "reflection", side] for side in ("top", "bottom"))
        assert np.abs(bottom / top - 1.0).max() > 0.05, "the two faces of this sheet differ"
    else:
        front, back = (readings[sample.name, "reflection", side] for side in ("top", "bottom"))
        assert back == pytest.approx(front, rel=1e-4)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked materials for measurements: the values of their tables, the exact values, and Cycles' values.

Views are Gauss nodes in theta over the columns for which the report gives errors, so means over views are means over
slices as in the report. Lights are quadrature rules in solid angle, so weighted sums over them are the norms of the
report: L2 over the hemisphere relative to the slice's norm.
"""

import math
from dataclasses import dataclass

import bpy
import goniophotometer
import numpy as np
import pytest

import lamina
from lamina import lobes
from lamina.baking.fit.mixture import LEAST_SHOWN
from lamina.closures import moving_lobes, shaped_lobes
from lamina.kinds.table import BASE, SHAPE, THROWN_BACK

OTHER = {"top": "bottom", "bottom": "top"}
BLACK = 1e-6  # share of a slice's largest value; darker values are not compared
LAST_COLUMN = 60  # the last of the 64 with a view cosine above .05

MIXTURE_RMS = 5e-3
PROMISE_FACTOR = 1.1
# Additional error of a weight interpolated between two columns or rows; the report gives the errors at both ends.
INTERPOLATION = 3.6e-3
FURNACE_ERROR, FURNACE_SIGMA = 1e-3, 3e-4
# Share of the incident light by which a sheet's R + T may be off. Of leaning and straight-through lobes a little is
# sampled beyond the horizon, where Cycles weighs it against the densities of the closures on that side: exact beside
# Diffuse and Translucent, but beside a Glossy closure or a Toon, whose density is higher than its value, up to 4 % of
# the lobe is lost.
STRAYED = 5e-3
SHEET_SIGMA = 1e-3  # against STRAYED
FURNACE_PATCHES = 24
PILOT_PATCHES, PILOT_SAMPLES, LEAST_SAMPLES, MOST_SAMPLES = 8, 256, 64, 16384


def _gauss(count, first, last):
    x, w = np.polynomial.legendre.leggauss(count)
    return first + 0.5 * (x + 1.0) * (last - first), 0.5 * w * (last - first)


# --- Directions ---------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Views:
    """View directions as positions between columns, and weights that sum up to 1."""

    columns: np.ndarray
    weights: np.ndarray

    @property
    def mu(self):
        return np.cos(self.columns / 63 * math.pi / 2)

    def mean(self, errors):
        """Mean over slices, from values at the views, shape (views, 3)."""
        return float(self.weights @ errors.mean(axis=1))


@dataclass(frozen=True, eq=False)
class Lights:
    """Light directions, each array (views or 1, lights). Slices are symmetric in dphi, so dphi in (0, pi) is enough."""

    mu: np.ndarray
    dphi: np.ndarray
    solid_angle: np.ndarray

    def norm2(self, values):
        """Squared L2 norm over solid angle of values (views, lights, 3), shape (views, 3)."""
        return np.einsum("vlc,vl->vc", values**2, np.broadcast_to(self.solid_angle, values.shape[:2]))


def gauss_views(count):
    columns, weights = _gauss(count, 0.0, LAST_COLUMN)
    return Views(columns, weights / LAST_COLUMN)


def hemisphere(cosines, azimuths):
    """A product Gauss rule, the same for all views."""
    return _product(*_gauss(cosines, 0.0, 1.0), *_gauss(azimuths, 0.0, math.pi))


def about_the_mirror_direction(views, cosines, azimuths, density):
    """For each view a rule of twice `cosines` by `azimuths` lights, denser about the mirror direction, where sharp
    lobes are: with x in (0, 1), distances grow as sinh(density x)."""
    x, w = _gauss(cosines, 0.0, 1.0)
    share, slope = np.sinh(density * x) / math.sinh(density), density * np.cosh(density * x) / math.sinh(density)
    y, v = _gauss(azimuths, 0.0, 1.0)
    dphi = math.pi * np.sinh(density * y) / math.sinh(density)
    dphi_weights = v * math.pi * density * np.cosh(density * y) / math.sinh(density)
    rules = []
    for mu_o in views.mu:
        mu = np.concatenate([mu_o * (1.0 - share), mu_o + (1.0 - mu_o) * share])
        weights = np.concatenate([mu_o * w * slope, (1.0 - mu_o) * w * slope])
        rules.append(_product(mu, weights, dphi, dphi_weights))
    return Lights(*(np.concatenate([getattr(rule, name) for rule in rules]) for name in ("mu", "dphi", "solid_angle")))


def _product(mu, mu_weights, dphi, dphi_weights):
    grid = np.meshgrid(mu, dphi, indexing="ij")
    return Lights(*(part.ravel()[None] for part in (*grid, 2.0 * np.outer(mu_weights, dphi_weights))))


# --- Materials ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Sample:
    """One baked material, its table, and its exact scattering function at the rendered thickness and base colour;
    `colour`: of a textured base."""

    name: str
    material: bpy.types.Material
    lut: lamina.Lut
    exact: lamina.ScatteringFunction
    views: Views
    row: float = 0.0
    colour: tuple[float, float, float] | None = None

    @property
    def is_sheet(self):
        return self.exact.stack.base is None

    @property
    def furnace_sigma(self):
        """The relative standard error of a furnace that shows errors of the size allowed."""
        return SHEET_SIGMA if self.is_sheet else FURNACE_SIGMA

    @property
    def parts(self):
        """(kind, side) of all slices of a material: a sheet is seen from both sides, by reflection and transmission."""
        kinds = ("reflection", "transmission") if self.is_sheet else ("reflection",)
        return [(kind, side) for kind in kinds for side in ("top", "bottom")]

    def table_side(self, side):
        """Index of the strips that a face reads: a table with one side is used for both faces."""
        return min(["top", "bottom"].index(side), len(self.lut.header["sides"]) - 1)

    def face(self, side):
        """The side of the stack that this face shows."""
        return self.lut.header["sides"][self.table_side(side)]

    def slices(self, kind, side, lights):
        """Exact f * mu_i, shape (views, lights, 3)."""
        side, mu_o = self.face(side), self.views.mu[:, None]
        if kind == "reflection":
            value = self.exact.brdf(mu_o, lights.mu, lights.dphi, side=side)
        else:  # light on one side that came in on the other
            value = self.exact.btdf(mu_o, lights.mu, lights.dphi, side=OTHER[side])
        value = value * lights.mu[..., None]
        return np.broadcast_to(value, (*value.shape[:2], 3))

    def mixture(self, kind, side, lights):
        """The fitted closures with weights interpolated like a texture, shape (views, lights, 3); without delta light,
        the mirror image and unscattered light."""
        strips = self._interpolated(self.lut.weights[self.table_side(side)].astype(float))
        strips = dict(zip(self.lut.closures, strips, strict=True))
        thrown_back = strips.pop(THROWN_BACK, None)
        total = 0.0
        shapes = {name: strips.pop(SHAPE + name) for name in list(strips) if shaped_lobes.is_shaped(name)}
        for name, weight in strips.items():
            if name == "transparent" or name.startswith("mirror:"):
                continue
            if name in shapes:
                if kind == "reflection":
                    moved = moving_lobes.values(shapes[name][:, None], self.views.mu[:, None], lights.mu, lights.dphi)
                    total = total + weight[:, None, :] * moved[..., None]
                continue
            if name.startswith(BASE):
                weight = weight * self.colour / (1.0 - np.array(self.colour) * thrown_back)
            lobe = lobes.by_id(name.removeprefix(BASE))
            if lobe.side == kind:
                shape = lobe.evaluate(self.views.mu[:, None], lights.mu, lights.dphi)
                total = total + weight[:, None, :] * shape[..., None]
        return total

    def promised(self, kind, side):
        """The report's slice errors, linear between columns and rows, shape (views, 3)."""
        key = "slice_errors" if kind == "reflection" else "slice_errors_transmission"
        errors = np.array(self.lut.report[key])[self.table_side(side)]  # [row, channel, column]
        errors = self._interpolated(np.moveaxis(errors, 1, 2))
        return np.broadcast_to(errors, (len(self.views.mu), 3))

    def mixture_albedo(self, side, dense):
        """Directional albedo of the fitted closures with weights interpolated like a texture, with the mirror image,
        of a stack on a base; shape (views, 3). `dense`: a rule for the integrals."""
        light = np.einsum("vlc,vl->vc", self.mixture("reflection", side, dense), dense.solid_angle)
        for name, weight in zip(self.lut.closures, self.lut.weights[self.table_side(side)].astype(float), strict=True):
            if name.startswith("mirror:"):
                light = light + self._interpolated(weight[None])[0]
        return light

    def albedo(self, side):
        """Exact directional albedo, with the mirror image and all light that passes a sheet; shape (views, 3)."""
        return self._albedo(side, self.views.mu)

    def albedo_between_columns(self, side):
        """The same, linear between the columns of the table: the best possible result of a table of this size."""
        column = self.views.columns.astype(int)
        right = (self.views.columns - column)[:, None]
        left, next_one = (self._albedo(side, np.cos((column + k) / 63 * math.pi / 2)) for k in (0, 1))
        return left * (1.0 - right) + next_one * right

    def _albedo(self, side, mu):
        side = self.face(side)
        total = self.exact.reflectance(mu, side)
        if self.is_sheet:
            total = total + self.exact.transmittance(mu, side)
        return np.broadcast_to(self.exact.stack.seen(total), (len(mu), 3))

    def mixture_rms(self, reading, kind, side, lights):
        """rms over the light directions of the relative difference, shape (views, 3)."""
        mixture = self.mixture(kind, side, lights)
        dark = np.maximum(mixture, BLACK * mixture.max(axis=1, keepdims=True))
        difference = (reading - mixture) / np.where(dark > 0.0, dark, 1.0)
        return np.sqrt(np.mean(difference**2, axis=1))

    def errors(self, reading, kind, side, lights, dense):
        """(errors from these lights alone, errors without their sampling error), relative L2 errors of shape (views,
        3).

        A few directions sample more or less of a closure's edges than the complete hemisphere. The difference is known
        from the closed forms: the second result replaces their part of the sum over `lights` by the sum over a `dense`
        rule (a control variate), so that only the difference of Cycles to the closed forms is sampled by few lights.
        Like the report's, it is relative to at least LEAST_SHOWN times the light of the brightest channel.
        """
        exact = self.slices(kind, side, lights)
        seen = lights.norm2(reading - exact)
        predicted = lights.norm2(self.mixture(kind, side, lights) - exact)
        dense_exact = self.slices(kind, side, dense)
        whole = dense.norm2(self.mixture(kind, side, dense) - dense_exact)
        scale = dense.norm2(dense_exact)
        scale = np.maximum(scale, LEAST_SHOWN**2 * scale.max(axis=1, keepdims=True))
        return np.sqrt(seen / lights.norm2(exact)), np.sqrt(np.maximum(whole + seen - predicted, 0.0) / scale)

    def _interpolated(self, table):
        """table [..., row, column, channel] at the sample's row and the views."""
        row, column = int(self.row), self.views.columns.astype(int)
        down, right = self.row - row, (self.views.columns - column)[:, None]
        lower = table[..., row, :, :]
        upper = table[..., min(row + 1, table.shape[-3] - 1), :, :]
        rows = lower * (1.0 - down) + upper * down
        return rows[..., column, :] * (1.0 - right) + rows[..., column + 1, :] * right


def made(stacks, samples_of, names):
    """Samples of stacks by their JSON, `samples_of(id, stack)` -> list, checked to have these names. A generator: the
    materials are removed at its end."""
    samples = []
    for data in stacks:
        stack = lamina.Stack.from_json({key: value for key, value in data.items() if key != "id"})
        samples += samples_of(data["id"], stack)
    assert [sample.name for sample in samples] == names
    yield samples
    for sample in samples:
        bpy.data.materials.remove(sample.material)


def make_sample(addon, name, stack, views, quality="final", basis=None):
    """The stack passes through the panel's properties, the bake and the node group, as for a user; the picture of the
    result in the panel is left out."""
    material = bpy.data.materials.new(name)
    addon.editing.stack_io.assign_stack(material, stack)
    basis = addon.base.preferences.table_basis(basis or material.lamina.basis)
    lut = lamina.bake(addon.editing.stack_io.to_stack(material), quality, basis=basis)
    addon.baking.bake_job.apply(material, lut)
    assert lut.header["stack_hash"] == stack.hash
    return Sample(name, material, lut, lamina.solve(stack), views)


def at_row(sample, row, name=None):
    """A copy of a sample, whose table has a thickness axis, at one row of it."""
    axis, stack = sample.lut.header["axes"]["tau"], sample.exact.stack
    largest = axis["values"][-1]
    share = row / (axis["count"] - 1) * largest / (largest + 0.5)
    thickness = 0.5 * share / (1.0 - share)
    material = sample.material.copy()
    group_node(material, sample.lut).inputs["Thickness"].default_value = thickness
    taus = [thickness / largest * stack.optics(stack.varying, c)[1] for c in range(stack.channels)]
    exact = sample.exact.with_thickness(stack.varying, taus)
    return Sample(name or sample.name, material, sample.lut, exact, sample.views, row)


def row_of(lut, thickness):
    """The position of this thickness on the table's axis, in rows."""
    axis = lut.header["axes"]["tau"]
    largest = axis["values"][-1]
    return (axis["count"] - 1) * thickness / (thickness + 0.5) * (largest + 0.5) / largest


def group_node(material, lut):
    """The node of the baked group in a material or a copy of it."""
    return next(node for node in material.node_tree.nodes
                if node.type == "GROUP" and node.node_tree.get("lamina_stack_hash") == lut.header["stack_hash"])


# --- Readings -----------------------------------------------------------------------------------


def under_the_sun(samples, kind, side, lights):
    """{(sample's name, kind, side): f * mu_i as seen in Cycles, shape (views, lights, 3)} of samples that show it;
    all have the same views."""
    seen = [sample for sample in samples if (kind, side) in sample.parts]
    if not seen:
        return {}
    mu_o = seen[0].views.mu
    mu, dphi = (np.broadcast_to(part, (len(mu_o), part.shape[1])) for part in (lights.mu, lights.dphi))
    # Every second light stands on the other side of the plane of incidence, where slices are the same.
    dphi = dphi * np.where(np.arange(dphi.shape[1]) % 2, -1.0, 1.0)
    materials = [sample.material for sample in seen]
    values = np.array([
        [
            goniophotometer.measure_many(
                materials, float(view), *light, samples=1, below=kind == "transmission", backface=side == "bottom"
            )
            for light in zip(mu[v], dphi[v], strict=True)
        ]
        for v, view in enumerate(mu_o)
    ])
    return {(sample.name, kind, side): values[:, :, k] for k, sample in enumerate(seen)}


def in_the_furnace(samples, sigma=None):
    """{(sample's name, side): (mean, its standard error), each of shape (views, 3)}; both faces of sheets. `sigma`: the
    relative standard error; None: each sample's own.

    Each material is rendered many times, at different pixels: the spread of its patches gives the error of the mean. A
    pilot render gives the number of samples. If this is too small, twice as many samples replace the first ones.
    """
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        # No sun below, so no pixel of a patch is in doubt: read all but those at the seams.
        patch.setattr(goniophotometer, "_READ", slice(1, 7))
        for side in ("top", "bottom"):
            seen = [sample for sample in samples if side == "top" or sample.is_sheet]
            if seen:
                mu_o = seen[0].views.mu.tolist()
                results = np.array([_furnace(seen, view, side == "bottom", sigma) for view in mu_o])
                found |= {(one.name, side): (results[:, k, 0], results[:, k, 1]) for k, one in enumerate(seen)}
    return found


def _furnace(seen, mu_o, backface, sigma):
    """[(mean, standard error) for each sample], shape (samples, 2, 3)."""
    pilot = _patches([sample.material for sample in seen], PILOT_PATCHES, mu_o, PILOT_SAMPLES, backface)
    spread = (pilot.std(axis=0, ddof=1) / pilot.mean(axis=0)).max(axis=-1)
    allowed = np.array([sigma or sample.furnace_sigma for sample in seen])
    # Variance falls at least as 1 / samples. Powers of two, at which Cycles' sequences converge best.
    wanted = PILOT_SAMPLES / FURNACE_PATCHES * (spread / allowed) ** 2
    results = []
    for sample, most, count in zip(seen, allowed, wanted, strict=True):
        count = min(max(2 ** math.ceil(math.log2(max(count, 1.0))), LEAST_SAMPLES), MOST_SAMPLES)
        while True:
            values = _patches([sample.material], FURNACE_PATCHES, mu_o, count, backface)[:, 0]
            mean, error = values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(FURNACE_PATCHES)
            if count >= MOST_SAMPLES or np.all(error < most * mean):
                break
            count *= 2
        results.append((mean, error))
    return results


def _patches(materials, repeats, mu_o, count, backface):
    """Furnace readings in one render, shape (repeats, materials, 3)."""
    assert repeats * len(materials) <= 100, "a second render would repeat the first one's random numbers"
    values = goniophotometer.furnace_many(materials * repeats, mu_o, count, backface)
    return values.reshape(repeats, len(materials), 3)

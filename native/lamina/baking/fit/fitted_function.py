# SPDX-License-Identifier: GPL-3.0-or-later
"""The fitted function of a lookup table outside Blender: the sum of closures that the node group renders.

As in Blender, the texels of each strip are interpolated linearly in the view angle, in t = tau / (tau + TAU_BEND) of a
varying layer and in roughness, and the closures are evaluated at the view itself."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...closures import following_lobes, lobes, shaped_lobes
from ...closures.axes import column_angles
from ...closures.closure_table import column_albedos
from ...common.arguments import broadcast, check_choice, check_number, cosines, finite_array
from ...common.errors import ArgumentError
from ...kinds.bases import LEAST_ALPHA, Lambert, PrincipledBase, ShaderBase
from ...kinds.fields import channel
from ...kinds.table import COLUMNS, PRINCIPLED, SHAPE, TAU_BEND, TILT, Strip, strips_of
from ...material.stack import Stack
from ...solver.solve import ScatteringFunction, solve
from .strip_factors import strip_factors

KINDS = {"reflect": "reflection", "transmit": "transmission"}
OTHER = {"top": "bottom", "bottom": "top"}
# Cycles treats a Glossy closure as a mirror if the square of its alpha is below this.
SINGULAR = 5e-7


@dataclass(frozen=True)
class Inputs:
    """Values of the node group's inputs. `color`: of a textured Lambert base or of a Principled base, three channels;
    `metallic`, `roughness`: of a Principled base."""

    color: np.ndarray
    metallic: float = 0.0
    roughness: float = 0.0

    @classmethod
    def of(cls, base) -> Inputs:
        """The values of the stack's own base, which the group's inputs have after the bake."""
        if isinstance(base, PrincipledBase):
            return cls(_three(base.color), base.metallic, base.roughness)
        return cls(_three(base.reflectance if isinstance(base, Lambert | ShaderBase) else 0.0))


def _three(value) -> np.ndarray:
    return np.array([channel(value, c if isinstance(value, tuple) and len(value) == 3 else 0) for c in range(3)])


@functools.lru_cache(maxsize=8)
def bare(base: PrincipledBase) -> ScatteringFunction:
    """The scattering function of a Principled base without layers."""
    return solve(Stack([], replace(base, inputs=())))


def _share(value, name: str) -> float:
    return check_number(value, name, "must lie in [0, 1]", lambda x: 0.0 <= x <= 1.0)


class FittedFunction:
    """The closures of one table for given inputs of its node group."""

    def __init__(self, header: dict, weights: np.ndarray, base, color=None, metallic=None, roughness=None):
        self.header, self.weights = header, weights
        self._strips, self._sides = strips_of(header), header["sides"]
        self._tau, self._azimuth = header["axes"]["tau"], header["axes"].get("azimuth")
        self._base = base
        self._inputs = self._checked(Inputs.of(base), color, metallic, roughness)
        count = header["axes"].get("roughness", {}).get("count", 1)
        self._texels = _at_roughness(weights, count, self._inputs.roughness)

    @property
    def has(self) -> dict[str, bool]:
        """Which inputs the table has, by name."""
        own = self._base.inputs if isinstance(self._base, PrincipledBase) else ()
        textured = isinstance(self._base, Lambert) and self._base.textured
        return {name: name in own or (name == "color" and textured) for name in ("color", "metallic", "roughness")}

    @property
    def base(self):
        """The base with the values of the inputs."""
        values = {name: getattr(self._inputs, name) for name, given in self.has.items() if given}
        if not isinstance(self._base, PrincipledBase):
            return self._base
        if "color" in values:
            values["color"] = tuple(float(x) for x in self._inputs.color)
        return replace(self._base, **values)

    def _checked(self, own: Inputs, color, metallic, roughness) -> Inputs:
        """The inputs with the given values instead of the stack's own. Raises ArgumentError for an input that the
        table does not have."""
        has = self.has
        for name, value in (("color", color), ("metallic", metallic), ("roughness", roughness)):
            if value is not None and not has[name]:
                raise ArgumentError(f"{name}: must be left out, this table has no input for the base's {name}")
        if color is not None:
            array = finite_array(color, "color")
            if array.shape not in ((), (1,), (3,)) or array.min() < 0.0 or array.max() > 1.0:
                raise ArgumentError(f"color = {color}: must be one number or three, in [0, 1]")
            own = replace(own, color=np.broadcast_to(array, (3,)))
        if metallic is not None:
            own = replace(own, metallic=_share(metallic, "metallic"))
        return own if roughness is None else replace(own, roughness=_share(roughness, "roughness"))

    def at_texels(self, sides: int) -> dict[str, np.ndarray]:
        """Weights of the closures at all texels, [side, row, column, 3], for viewers on `sides` sides: a table of one
        side serves both."""
        texels = np.broadcast_to(self._texels, (sides, *self._texels.shape[1:]))
        return self._weights(lambda index: texels[:, index])

    def shapes_at_texels(self, sides: int) -> dict[str, np.ndarray]:
        """Shapes of the closures that move with the view at all texels, [side, row, column, numbers]."""
        texels = np.broadcast_to(self._texels, (sides, *self._texels.shape[1:]))
        return self._shapes(lambda index: texels[:, index])

    def shown(self, closure: str) -> str:
        """The id of a closure of `at_texels` with its width at this roughness; of microfacets too narrow for the
        light grid of a bake, that of a mirror with this width."""
        if following_lobes.is_sharp(closure, self._inputs.roughness, LEAST_ALPHA):
            return following_lobes.as_mirror(closure, self._inputs.roughness)
        return following_lobes.at(closure, self._inputs.roughness)

    def is_specular(self, closure: str) -> bool:
        """True for a closure whose light is specular in the solver: a mirror, or one that follows facets of the base
        that are solved as a mirror."""
        own_facets = following_lobes.is_sharp(closure, 0.0, LEAST_ALPHA)
        return closure.startswith("mirror:") or (own_facets and self._inputs.roughness**2 < LEAST_ALPHA)

    def _at(self, mu_o: np.ndarray, tau: np.ndarray, phi: np.ndarray | None,
            viewer: str) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """(weights, shapes), (points, 3) and (points, numbers), of the closures for these views; `phi`: azimuths from
        the tangent of the rows."""
        side = min(self._sides.index(viewer) if viewer in self._sides else 0, len(self._sides) - 1)
        column = np.arccos(np.clip(mu_o, 0.0, 1.0)) / column_angles()[-1] * (COLUMNS - 1)
        row, turn = _row(tau, self._tau), np.zeros(mu_o.shape)
        if phi is not None:
            turn = phi % math.pi / math.pi * (self._azimuth["count"] - 1)
        block = max(1, self._tau["count"])
        first = turn.astype(int)

        def texels(index: int) -> np.ndarray:
            strip = self._texels[side, index]
            below = _interpolated(strip, first * block + row, column)
            if phi is None:
                return below
            above = _interpolated(strip, (first + 1) * block + row, column)
            return below + (turn - first)[:, None] * (above - below)

        return self._weights(texels), self._shapes(texels)

    def _shapes(self, texels: Callable[[int], np.ndarray]) -> dict[str, np.ndarray]:
        """The shapes of the closures that move with the view, see closures.shaped_lobes."""
        shapes = {strip.closure: texels(index) for index, strip in enumerate(self._strips) if strip.role == SHAPE}
        for index, strip in enumerate(self._strips):
            if strip.role == TILT:
                shapes[strip.closure] = np.concatenate([shapes[strip.closure], texels(index)[..., :2]], axis=-1)
        return shapes

    def _weights(self, texels: Callable[[int], np.ndarray]) -> dict[str, np.ndarray]:
        """The weight of each closure (a lobe's id, "transparent", "mirror:ALPHA" or PRINCIPLED) as the node group
        computes it. Ids of closures that follow the roughness stay as they are. `texels(index)`: those of one strip, R
        G B along the last axis."""
        strips, own = self._strips, Strip(role=PRINCIPLED)
        factors = strip_factors(strips, lambda strip: texels(strips.index(strip)), self._inputs.color,
                                self._inputs.metallic)
        weights: dict[str, np.ndarray] = {}
        for index, strip in enumerate(strips):
            if strip.is_weight:
                weight = texels(index) * factors.get((strip.role, strip.metal), 1.0)
                weights[strip.closure] = weights[strip.closure] + weight if strip.closure in weights else weight
        return weights | ({PRINCIPLED: texels(strips.index(own))} if own in strips else {})

    def values(self, mu_o, mu_i, dphi, path: str, side: str, tau, phi_o) -> np.ndarray:
        """See Lut.evaluate."""
        kind, viewer = self._sight(path, side)
        names = ("mu_o", "mu_i", "dphi", "tau", "phi_o")
        given = [cosines(finite_array(mu_o, "mu_o"), "mu_o"), cosines(finite_array(mu_i, "mu_i"), "mu_i"),
                 finite_array(dphi, "dphi"), self._thickness(tau), finite_array(phi_o, "phi_o")]
        arrays = broadcast(given, names)
        o, i, azimuth, taus, phi = (np.asarray(array, float).ravel() for array in arrays)
        turn = self._from_tangent(phi)
        found = np.zeros((o.size, 3))
        weights, shapes = self._at(o, taus, turn, viewer)
        for closure, weight in weights.items():
            name = self.shown(closure)
            if name in shapes:
                if kind == "reflection":
                    found += weight * shaped_lobes.values(shapes[name], o, i, azimuth, turn)[:, None]
            elif name == PRINCIPLED:
                if kind == "reflection":
                    found += weight * bare(self.base).brdf(o, i, azimuth) * i[:, None]
            elif (lobe := finite_lobe(name)) is not None and lobe.side == kind:
                found += weight * lobe.evaluate(o, i, azimuth)[:, None]
        return (found / i[:, None]).reshape(*arrays[0].shape, 3)

    def albedo(self, mu_o, path: str, side: str, tau, phi_o) -> tuple[np.ndarray, np.ndarray]:
        """(by closures that spread light, by mirrors or unscattered), each of the broadcast shape + (3,)."""
        kind, _ = self._sight(path, side)
        arrays = broadcast([cosines(finite_array(mu_o, "mu_o"), "mu_o"), self._thickness(tau),
                            finite_array(phi_o, "phi_o")], ("mu_o", "tau", "phi_o"))
        o, taus, phi = (np.asarray(array, float).ravel() for array in arrays)
        turn = self._from_tangent(phi)
        spread, direct = np.zeros((2, o.size, 3))
        angle = np.arccos(o)
        weights, shapes = self._at(o, taus, turn, side)
        for closure, weight in weights.items():
            name = self.shown(closure)
            if name in shapes:
                if kind == "reflection":
                    spread += weight * shaped_lobes.albedos(shapes[name], o, turn)[:, None]
            elif name == PRINCIPLED:
                if kind == "reflection":
                    scattered, mirrored = bare(self.base).reflectance(o, parts=True)
                    spread += weight * scattered
                    direct += weight * mirrored
            elif name == "transparent":
                direct += weight * (kind == "transmission")
            elif name.startswith("mirror:"):
                direct += weight * (kind == "reflection")
            elif lobes.by_id(name).side == kind:
                spread += weight * np.interp(angle, column_angles(), column_albedos((name,))[:, 0])[:, None]
        return spread.reshape(*arrays[0].shape, 3), direct.reshape(*arrays[0].shape, 3)

    def _from_tangent(self, phi_o: np.ndarray) -> np.ndarray | None:
        """Azimuths from the tangent of the rows; None for a table without such rows."""
        return None if self._azimuth is None else phi_o - self._azimuth["tangent"]

    def _sight(self, path: str, side: str) -> tuple[str, str]:
        """(kind of light, side of the viewer). Raises ArgumentError."""
        kind = KINDS[check_choice(path, "path", KINDS, "'reflect' or 'transmit'")]
        check_choice(side, "side", OTHER, "'top' or 'bottom'")
        if self._base is not None and (side == "bottom" or kind == "transmission"):
            name = "path = 'transmit'" if kind == "transmission" else "side = 'bottom'"
            raise ArgumentError(f"{name}: must not be asked of a table whose stack has a base")
        return kind, side if kind == "reflection" else OTHER[side]

    def _thickness(self, tau) -> np.ndarray:
        """Thicknesses of the varying layer, by default the largest. Raises ArgumentError."""
        axis = self._tau
        if axis["count"] <= 1:
            if tau is not None:
                raise ArgumentError("tau: must be left out, no layer of this table varies")
            return np.zeros(())
        largest = axis["values"][-1]
        array = finite_array(largest if tau is None else tau, "tau")
        outside = (array < 0.0) | (array > largest)
        if np.any(outside):
            raise ArgumentError(f"tau = {array[outside].flat[0]:g}: must lie in [0, {largest:g}], the thicknesses of "
                                "this table")
        return array


def with_inputs_of(function: FittedFunction, base) -> FittedFunction:
    """The same table with the values of another base for the inputs that the table has."""
    theirs = Inputs.of(base)
    values = {name: getattr(theirs, name) for name, given in function.has.items() if given}
    return FittedFunction(function.header, function.weights, function.base, **values)


@functools.lru_cache(maxsize=256)
def finite_lobe(name: str):
    """The lobe with this id, also of a mirror with a width; None for light without a finite value."""
    if name in ("transparent", PRINCIPLED):
        return None
    if not name.startswith("mirror:"):
        return lobes.by_id(name)
    alpha = float(name.removeprefix("mirror:"))
    return lobes.ggx(alpha**0.5, name=name) if alpha > SINGULAR else None


def _at_roughness(weights: np.ndarray, count: int, roughness: float) -> np.ndarray:
    """The table [side, closure, tau row, column, 3] at one roughness; `count` roughnesses are uniform from 0 to 1."""
    if count < 2:
        return weights
    blocks = weights.reshape(*weights.shape[:2], count, -1, *weights.shape[3:])
    place = np.clip(roughness, 0.0, 1.0) * (count - 1)
    below = min(int(place), count - 2)
    share = place - below
    return (1.0 - share) * blocks[:, :, below] + share * blocks[:, :, below + 1]


def _row(tau: np.ndarray, axis: dict) -> np.ndarray:
    """The place of each thickness among the rows, from 0 to the last."""
    if axis["count"] <= 1 or axis["values"][-1] <= 0.0:
        return np.zeros(tau.shape)
    last = axis["values"][-1]
    return tau / (tau + TAU_BEND) * (last + TAU_BEND) / last * (axis["count"] - 1)


def _interpolated(strip: np.ndarray, row: np.ndarray, column: np.ndarray) -> np.ndarray:
    """A strip [row, column, 3] at fractional places, bilinear."""
    found = np.zeros((row.size, 3))
    above = np.clip(row.astype(int), 0, max(strip.shape[0] - 2, 0))
    left = np.clip(column.astype(int), 0, strip.shape[1] - 2)
    down = np.clip(row - above, 0.0, 1.0)
    right = np.clip(column - left, 0.0, 1.0)
    for rows, share in ((above, 1.0 - down), (np.minimum(above + 1, strip.shape[0] - 1), down)):
        found += (share * (1.0 - right))[:, None] * strip[rows, left] + (share * right)[:, None] * strip[rows, left + 1]
    return found

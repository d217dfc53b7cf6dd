# SPDX-License-Identifier: GPL-3.0-or-later
"""A Principled base with inputs below an interface: varnish, lacquer or water on a textured material.

The light over the stack is that of the layers over black, which no input changes, plus the light that the base adds,
see base_light. Roughness is an axis of the table, as in bases.principled. Closures for lobes follow the input, see
following_lobes.

Metallic m mixes the light of the dielectric and of the metal. Light that the base reflects once mixes linearly. Light
that the interface traps meets both: a dielectric scatters trapped light into all directions, and the share r of this
light stays in, whereas a metal reflects most of this light at the angle of incidence, and the share t stays in. The
repeated light of the dielectric therefore has r' = (1 - m) r + m t in place of r. t is chosen for each view so that the
albedo is exact at m = c = 1/2.

Two kinds of closures share the table: a few for a diffuse base, and more for any other base. All strips of one closure
are added before the closure is evaluated."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...closures import following_lobes, lobes, narrow_lobes
from ...closures.closure_table import column_albedos, view_cosines
from ...common.progress import Progress, portion
from ...kinds.bases import LEAST_ALPHA, Black, PrincipledBase
from ...kinds.boundaries import Interface
from ...kinds.fields import channel, mean
from ...kinds.table import DARK, THROWN_BACK, TRAPPED, Strip
from ...material.stack import Stack
from ..fit.following_fit import FollowingFit
from ..fit.geometric_series import repeated
from ..fit.mixture import Part
from ..fit.slices import Slices, SolvedRows, joined, seen_whole, slices
from ..fit.stack_fit import StackFit
from .base import WithInputs
from .base_light import COLORS, BaseLight, Reflections, beyond, of_colors
from .fixed import Fixed
from .job import Basis, Job
from .principled import ROUGH_STRIDE

# Roughnesses of the table, uniform from 0 to 1. Facets of the first SHARP ones are solved as mirrors with the energy of
# the facets.
ROUGHNESSES, SHARP = 11, 2
HALF = 0.5


class Covered(WithInputs):
    """`stride`: of the rows of thickness that are solved."""

    rows = ROUGHNESSES

    def __init__(self, job: Job):
        super().__init__(job)
        self.stride = max(job.row_stride, ROUGH_STRIDE[job.quality] if self.roughnesses else 1)

    @staticmethod
    def most_strips(stack: Stack, limits: Basis) -> int:
        return Fixed.most_strips(stack, limits)

    def parts(self) -> list[Part]:
        job, step, count = self.job, self.step, len(self.every)

        # Fit the light of the layers over black
        bare = self.stack.with_facets(self.stack.layers, Black())
        self.solved, black = self._over(bare.base, portion(step, 0.0, 0.1))
        if self.inputs == ("roughness",):  # the base adds light in each channel of its color; the layers may have one
            black = black.each(lambda part: np.repeat(part, self.stack.table_channels // part.shape[2], axis=2))
        own = StackFit(bare, self.solved, self.grid, self.pool, self.search)(
            "reflection", black, self.limits.reflected, job.closures(), portion(step, 0.1, 0.15), True)
        table = [Part.of(own.closures, np.tile(own.weights, (1, 1, count, 1, 1)))]  # the same at each roughness
        black = joined([black] * count)
        if np.any(black.direct):
            table.append(Part.single(Strip(narrow_lobes.mirror(bare)), black.direct))

        # For each metallic value, solve the light that the base adds, choose closures, and fit their weights
        mirror = narrow_lobes.mirror(self.stack)
        known = self._given()
        lights = []
        for number, metallic in enumerate(self.ends):
            start = 0.15 + 0.4 * number
            light = self._light(metallic, black, portion(step, start, start + 0.35))
            fitting = functools.partial(step, start + 0.35, "Fitting the light of the base")
            fit = FollowingFit(self.grid, self.every, self.pool, self.search, fitting)
            names = known[number] if known else self._choose(fit, light, metallic)
            for role, seen in light.parts().items():
                table.append(Part.of([*names, mirror], _with_mirror(fit, seen, names), role, number > 0))
            if light.colored is not None:
                table.append(Part.single(Strip(role=THROWN_BACK, metal=number > 0), light.colored.thrown_back))
            lights.append(light.albedos())  # slices of all roughnesses take most of the memory
        colored = [light.colored for light in lights if light.colored is not None]
        if len(colored) > 1:
            plastic, metal = colored
            others = black.whole + HALF * (lights[0].dark.whole + lights[1].dark.whole)
            trapped = self._trapped(others, plastic, metal, portion(step, 0.95, 1.0))
            table.append(Part.single(Strip(role=TRAPPED), trapped))
        return table

    def _solved(self, base, step: Progress) -> SolvedRows:
        """The layers over another base."""
        return self.job.solved(self.stack.with_facets(self.stack.layers, base), step, self.stride)

    def _over(self, base, step: Progress) -> tuple[SolvedRows, Slices]:
        """(the layers over another base, their slices)."""
        solved = self._solved(base, portion(step, 0.0, 0.5))
        return solved, slices(solved, self.grid, self.pool, portion(step, 0.5, 1.0))["reflection"]

    def _flux(self, base, step: Progress) -> np.ndarray:
        """The whole albedo over another base, [side, row, channel, column]."""
        found = [seen_whole(function, view_cosines()) for function in self._solved(base, step).functions]
        return np.moveaxis(np.stack(found), 2, 1)[None]

    def _at_each_roughness(self, base: PrincipledBase, step: Progress) -> Iterator[tuple[PrincipledBase, Progress]]:
        """(the base, a step function) for each roughness of the table."""
        count = len(self.every)
        for k, roughness in enumerate(self.every):
            yield replace(base, roughness=roughness), portion(step, k / count, (k + 1) / count)

    def _is_diffuse(self, metallic: float) -> bool:
        """True if the base is a dielectric without specular reflection, so that its roughness has no effect."""
        above = [layer.ior for layer in self.stack.layers if isinstance(layer, Interface)][-1]
        matched = all(channel(above, c) >= self.base.ior for c in range(self.stack.channels))
        return metallic == 0.0 and (matched or self.base.specular == 0.0)

    def _light(self, metallic: float, black: Slices, step: Progress) -> BaseLight:
        """The light that a base of this metallic value adds, for all roughnesses; only for its own color if neither
        color nor metallic is an input."""
        count = len(self.every)
        rows = slice(0, black.albedo.shape[1] // count)
        bare = black.each(lambda part: part[:, rows])
        found: list[BaseLight] = []
        for base, part in self._at_each_roughness(replace(self.base, metallic=metallic), step):
            if found and self._is_diffuse(metallic):
                found.append(found[0])  # equal for the solver
            elif self.inputs == ("roughness",):
                found.append(BaseLight(beyond(self._over(base, part)[1], bare)))
            else:
                seen = [self._over(replace(base, color=color), portion(part, 0.25 * k, 0.25 * (k + 1)))[1]
                        for k, color in enumerate(COLORS[:3])]
                last = self._flux(replace(base, color=COLORS[3]), portion(part, 0.75, 1.0))
                found.append(of_colors(bare, seen, last))
        return BaseLight.joined(found)

    def _trapped(self, dark: np.ndarray, plastic: Reflections, metal: Reflections, step: Progress) -> np.ndarray:
        """t, [side, row, channel, column], from the albedo at m = c = 1/2; `dark`: the part of it that no color
        changes."""
        mixed = replace(self.base, metallic=HALF, color=HALF)
        seen = np.concatenate([self._flux(base, part) for base, part in self._at_each_roughness(mixed, step)], axis=1)
        once = HALF * (plastic.first.whole + metal.first.whole)
        left = seen - dark - HALF * (once + repeated(HALF, metal.thrown_back) * metal.again.whole)
        # left = m c^2 E / (1 - c + c E) of the light of the dielectric, with E = 1 - r'
        most = HALF * HALF**2 * plastic.again.whole
        share = np.clip(np.where(most > 0.0, left / np.where(most > 0.0, most, 1.0), 0.0), 0.0, 1.0)
        leaves = share * (1.0 - HALF) / (1.0 - HALF * share)
        return np.clip((1.0 - leaves - HALF * plastic.thrown_back) / HALF, 0.0, 1.0)

    def _given(self) -> list[list[str]]:
        """The closures of each end in an earlier table, if all of them are still candidates."""
        given = [self.job.closures(DARK, number > 0) for number in range(len(self.ends))]
        allowed = {*_dictionary(), *self._made()}
        return given if all(given) and allowed >= {name for names in given for name in names} else []

    def _choose(self, fit: FollowingFit, light: BaseLight, metallic: float) -> list[str]:
        """The closures of one end: few for a diffuse base, more for any other base."""
        few, more = self.limits.covered
        if self._is_diffuse(metallic):
            return fit.choose(light.extremes(), _dictionary(), few)
        return fit.choose(light.extremes(), [*_dictionary(), *self._made()], more)

    def _made(self) -> list[str]:
        """Closures made for the lobes of the base, which follow its roughness if that is an input."""
        if len(self.every) == 1:
            return narrow_lobes.closures(self.stack)
        # Refraction stretches a lobe by the index. Facets deflect light that crosses an interface twice
        above = [layer for layer in self.stack.layers if isinstance(layer, Interface)]
        index = mean(above[-1].ior)
        rough = max(layer.alpha for layer in above)
        least = 2.0**0.5 * abs(index - 1.0) * rough if rough >= LEAST_ALPHA else 0.0
        names = [following_lobes.ggx(index * width, least * width) for width in following_lobes.WIDTHS]
        for width in (0.4, 1.0):
            names += [following_lobes.toon(index * width, least * width, lean, size, smooth)
                      for lean in narrow_lobes.LEANS for size, smooth in narrow_lobes.CONES]
        return names + narrow_lobes.halos(self.stack)


def _dictionary() -> list[str]:
    return [lobe.id for lobe in lobes.DICTIONARY if lobe.side == "reflection"]


def _with_mirror(fit: FollowingFit, light: Slices, names: list[str]) -> np.ndarray:
    """Weights of `names` and of the mirror. Where the roughness is an input, specular reflection
    by sharp facets belongs to the microfacet closures that follow, in the proportion of the next roughness."""
    weights = fit.fit(light, names)
    direct, rows = light.direct.copy(), light.direct.shape[1] // len(fit.roughnesses)
    follows = np.array([name.startswith(following_lobes.GGX) for name in names])
    if len(fit.roughnesses) > 1 and follows.any():
        next_rows = slice(SHARP * rows, (SHARP + 1) * rows)
        shares = weights[:, :, next_rows] * follows[:, None, None, None]
        total = shares.sum(axis=1, keepdims=True)
        first = (np.arange(len(names)) == follows.argmax())[:, None, None, None]
        shares = np.where(total > 0.0, shares / np.where(total > 0.0, total, 1.0), first)
        for sharp in range(SHARP):
            mine = slice(sharp * rows, (sharp + 1) * rows)
            lobe = np.maximum(direct[:, mine] - direct[:, next_rows], 0.0)
            direct[:, mine] -= lobe
            albedo = _albedos(names, fit.roughnesses[sharp])
            weights[:, :, mine] += shares * lobe[:, None] / albedo[:, None, None]
    return np.concatenate([weights, direct[:, None]], axis=1)


def _albedos(names: list[str], roughness: float) -> np.ndarray:
    """Directional albedos [closure, column] at this roughness; 1 for microfacets too narrow for a table."""
    found = column_albedos(tuple(following_lobes.at(name, roughness) for name in names)).T.copy()
    found[[following_lobes.is_sharp(name, roughness, LEAST_ALPHA) for name in names]] = 1.0
    return found

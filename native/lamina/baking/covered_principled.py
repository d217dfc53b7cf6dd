# SPDX-License-Identifier: GPL-3.0-or-later
"""A Principled base with inputs below an interface: varnish, lacquer or water on a textured material.

The light over the stack is that of the layers over black, which no input changes, plus the light that the base adds,
see base_light. Roughness is an axis of the table, as in principled_base. Closures for lobes follow the input, see
following_lobes.

Metallic m mixes the light of the dielectric and of the metal. Light that the base reflects once mixes linearly. Light
that the interface traps meets both: a dielectric scatters trapped light into all directions, and the share r of this
light stays in, whereas a metal reflects most of this light at the angle of incidence, and the share t stays in. The
repeated light of the dielectric therefore has r' = (1 - m) r + m t in place of r. t is chosen for each view so that the
albedo is exact at m = c = 1/2.

Two kinds of closures share the table: a few for a diffuse base, and more for any other base. All strips of one closure
are added before the closure is evaluated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .._core import ThreadPool
from ..closures import following_lobes, lobes, narrow_lobes
from ..closures.closure_table import LightGrid, column_albedos, grid_for, view_cosines
from ..common.progress import Progress, portion
from ..kinds.bases import LEAST_ALPHA, Black, PrincipledBase
from ..kinds.boundaries import Interface
from ..kinds.fields import channel
from ..kinds.table import DARK, METAL, THROWN_BACK, TRAPPED
from ..material.stack import Stack
from ..solver.solve import thread_pool
from .base_light import COLORS, BaseLight, Reflections, beyond, of_colors, repeated
from .following_fit import FollowingFit
from .mixture import Mixture
from .principled_base import ROUGH_STRIDE
from .slices import Slices, SolvedRows, along_rows, slices, solve_rows
from .stack_fit import StackFit

# Roughnesses of the table, uniform from 0 to 1. Facets of the first SHARP ones are solved as mirrors with the energy of
# the facets.
ROUGHNESSES, SHARP = 11, 2
HALF = 0.5


def is_covered(stack: Stack) -> bool:
    """True for a Principled base with inputs below an interface."""
    return (isinstance(stack.base, PrincipledBase) and bool(stack.base.inputs)
            and any(isinstance(layer, Interface) for layer in stack.layers))


def narrowest(stack: Stack) -> float | None:
    """Alpha of the narrowest lobe that the table holds, or None."""
    follows = isinstance(stack.base, PrincipledBase) and "roughness" in stack.base.inputs
    return LEAST_ALPHA if follows else narrow_lobes.narrowest(stack)


@dataclass(frozen=True)
class _Work:
    """What all variants of a stack share. `base`: the base without inputs; `roughnesses`: those of the table."""

    stack: Stack
    base: PrincipledBase
    roughnesses: list[float]
    quality: str
    threads: int
    stride: int
    nodes: int | None
    grid: LightGrid
    pool: ThreadPool

    def over(self, base, step: Progress) -> tuple[SolvedRows, Slices]:
        """(the layers over another base, their slices)."""
        solved = self._solved(base, portion(step, 0.0, 0.5))
        return solved, slices(solved, self.grid, self.pool, portion(step, 0.5, 1.0))["reflection"]

    def flux(self, base, step: Progress) -> np.ndarray:
        """The whole albedo over another base, [side, row, channel, column]."""
        found = [function.reflectance(view_cosines()) for function in self._solved(base, step).functions]
        return np.moveaxis(np.stack(found), 2, 1)[None]

    def at_each_roughness(self, base: PrincipledBase, step: Progress):
        """(the base, a step function) for each roughness of the table."""
        count = len(self.roughnesses)
        for k, roughness in enumerate(self.roughnesses):
            yield replace(base, roughness=roughness), portion(step, k / count, (k + 1) / count)

    def is_diffuse(self, metallic: float) -> bool:
        """True if the base is a dielectric without specular reflection, so that its roughness has no effect."""
        above = [layer.ior for layer in self.stack.layers if isinstance(layer, Interface)][-1]
        matched = all(channel(above, c) >= self.base.ior for c in range(self.stack.channels))
        return metallic == 0.0 and (matched or self.base.specular == 0.0)

    def _solved(self, base, step: Progress) -> SolvedRows:
        stack = self.stack.with_facets(self.stack.layers, base)
        return solve_rows(stack, self.quality, self.threads, step, self.stride, self.nodes)


def parts(stack: Stack, quality: str, threads: int, step: Progress, stride: int, nodes: int | None,
          given: dict[str, list[str]], counts: tuple[int, int], own_counts: tuple[int, int, int], search: dict):
    """(parts of the table by kind, the solved rows over black, the roughnesses of the table's axis). `counts`: largest
    numbers of closures for a diffuse base, and for any other; `own_counts`: for the layers' own light, see bake.Basis.
    Raises StackError."""
    base = stack.base
    assert isinstance(base, PrincipledBase)
    follows = "roughness" in base.inputs
    roughnesses = np.linspace(0.0, 1.0, ROUGHNESSES).tolist() if follows else [base.roughness]
    if follows:
        stride = max(stride, ROUGH_STRIDE[quality])
    grid = grid_for(quality, narrowest(stack), narrow_lobes.has_halo(stack))
    work = _Work(stack, replace(base, inputs=()), roughnesses, quality, threads, stride, nodes, grid,
                 thread_pool(threads))

    # Fit the light of the layers over black
    bare = stack.with_facets(stack.layers, Black())
    solved, black = work.over(bare.base, portion(step, 0.0, 0.1))
    own = StackFit(bare, solved, grid, work.pool, search)("reflection", black, own_counts, given["reflection"],
                                                          portion(step, 0.1, 0.15), True)
    black = along_rows([black] * len(roughnesses))

    # Solve the light that the base adds
    ends = (0.0, 1.0) if "metallic" in base.inputs else (base.metallic,)
    has_colors = base.inputs != ("roughness",)
    lights = [_light(work, metallic, black, has_colors, portion(step, 0.15 + 0.35 * k, 0.15 + 0.35 * (k + 1)))
              for k, metallic in enumerate(ends)]

    # Choose closures, and fit their weights
    fit = FollowingFit(grid, roughnesses, work.pool, search, lambda: step(0.9, "Fitting the light of the base"))
    chosen = _choose(work, fit, lights, ends, given, counts)
    table: dict[str, Mixture] = {"reflection": _tiled(own, len(roughnesses))}
    if np.any(black.direct):
        name = narrow_lobes.mirror(bare)
        table[name] = Mixture([name], black.direct[:, None])
    mirror = narrow_lobes.mirror(stack)
    for number, (light, names) in enumerate(zip(lights, chosen, strict=True)):
        prefix = METAL if number else ""
        for kind, part in light.parts().items():
            weights = _with_mirror(fit, part, names)
            table[prefix + kind] = Mixture([prefix + kind + name for name in (*names, mirror)], weights)
        if light.colored is not None:
            table[prefix + THROWN_BACK] = Mixture([prefix + THROWN_BACK], light.colored.thrown_back[:, None])
    colored = [light.colored for light in lights if light.colored is not None]
    if len(colored) > 1:
        others = black.whole + HALF * (lights[0].dark.whole + lights[1].dark.whole)
        plastic, metal = colored
        trapped = _trapped(work, others, plastic, metal, portion(step, 0.85, 0.9))
        table[TRAPPED] = Mixture([TRAPPED], trapped[:, None])

    return table, solved, roughnesses if follows else []


def _tiled(own: Mixture, count: int) -> Mixture:
    """The same rows for each of `count` roughnesses."""
    return Mixture(own.closures, np.tile(own.weights, (1, 1, count, 1, 1)))


def _light(work: _Work, metallic: float, black: Slices, has_colors: bool, step: Progress) -> BaseLight:
    """The light that a base of this metallic value adds, for all roughnesses; without `has_colors`, only for its own
    color."""
    count = len(work.roughnesses)
    rows = slice(0, black.albedo.shape[1] // count)
    bare = Slices(black.values[:, rows], black.albedo[:, rows], None, black.direct[:, rows])
    found: list[BaseLight] = []
    for base, part in work.at_each_roughness(replace(work.base, metallic=metallic), step):
        if found and work.is_diffuse(metallic):
            found.append(found[0])  # equal for the solver
        elif not has_colors:
            found.append(BaseLight(beyond(work.over(base, part)[1], bare)))
        else:
            seen = [work.over(replace(base, color=color), portion(part, 0.25 * k, 0.25 * (k + 1)))[1]
                    for k, color in enumerate(COLORS[:3])]
            last = work.flux(replace(base, color=COLORS[3]), portion(part, 0.75, 1.0))
            found.append(of_colors(bare, seen, last))
    return BaseLight.joined(found)


def _trapped(work: _Work, dark: np.ndarray, plastic: Reflections, metal: Reflections, step: Progress) -> np.ndarray:
    """t, [side, row, channel, column], from the albedo at m = c = 1/2; `dark`: the part of it that no color changes."""
    mixed = replace(work.base, metallic=HALF, color=HALF)
    seen = np.concatenate([work.flux(base, part) for base, part in work.at_each_roughness(mixed, step)], axis=1)
    once = HALF * (plastic.first.whole + metal.first.whole)
    left = seen - dark - HALF * (once + repeated(HALF, metal.thrown_back) * metal.again.whole)
    # left = m c^2 E / (1 - c + c E) of the light of the dielectric, with E = 1 - r'
    most = HALF * HALF**2 * plastic.again.whole
    share = np.clip(np.where(most > 0.0, left / np.where(most > 0.0, most, 1.0), 0.0), 0.0, 1.0)
    leaves = share * (1.0 - HALF) / (1.0 - HALF * share)
    return np.clip((1.0 - leaves - HALF * plastic.thrown_back) / HALF, 0.0, 1.0)


def _choose(work: _Work, fit: FollowingFit, lights: list[BaseLight], ends: tuple[float, ...],
            given: dict[str, list[str]], counts: tuple[int, int]) -> list[list[str]]:
    """The closures of each end: few for a diffuse base, more for any other base."""
    dictionary = [lobe.id for lobe in lobes.DICTIONARY if lobe.side == "reflection"]
    candidates = [*dictionary, *_made(work)]
    taken = [[name for name in given[prefix] if name in candidates] for prefix in (DARK, METAL + DARK)[:len(lights)]]
    if all(taken) and [len(names) for names in taken] == [len(given[DARK]), len(given[METAL + DARK])][:len(lights)]:
        return taken
    found = []
    for light, metallic in zip(lights, ends, strict=True):
        names, count = (dictionary, counts[0]) if work.is_diffuse(metallic) else (candidates, counts[1])
        found.append(fit.choose(light.extremes(), names, count))
    return found


def _made(work: _Work) -> list[str]:
    """Closures made for the lobes of the base, which follow its roughness if that is an input."""
    if len(work.roughnesses) == 1:
        return narrow_lobes.closures(work.stack)
    # Refraction stretches a lobe by the index. Facets deflect light that crosses an interface twice
    above = [layer for layer in work.stack.layers if isinstance(layer, Interface)]
    index = narrow_lobes.mean(above[-1].ior)
    rough = max(layer.alpha for layer in above)
    least = 2.0**0.5 * abs(index - 1.0) * rough if rough >= LEAST_ALPHA else 0.0
    names = [following_lobes.ggx(index * width, least * width) for width in following_lobes.WIDTHS]
    for width in (0.4, 1.0):
        names += [following_lobes.toon(index * width, least * width, lean, size, smooth)
                  for lean in narrow_lobes.LEANS for size, smooth in narrow_lobes.CONES]
    return names + narrow_lobes.halos(work.stack)


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

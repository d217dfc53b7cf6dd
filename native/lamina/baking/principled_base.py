# SPDX-License-Identifier: GPL-3.0-or-later
"""A Principled base below layers without boundaries: the BSDF itself, attenuated by the layers, and closures for the
rest of the light.

Let V0 be the slice of the bare base and V that of the stack. The node group holds the Principled BSDF with the weight
w(view), the share of the base's lobe that layers neither scatter nor absorb, and closures fitted to V - w V0. Without
layers w is 1 and the rest is 0, so the group shows the BSDF itself.

Inputs of the group. The BSDF has the sockets' values. The rest depends on the base's color c as

    rest(c) = rest(0) + c / (1 - c r) * A

which is exact for a diffuse base, see geometric_series. For a metal, r is chosen for each view so that the albedo is
exact at c = 0, 1/2 and 1. Metallic mixes the rests of metallic 0 and 1 linearly. Roughness is an axis of the table,
around that of thickness: the rows of all thicknesses at the first roughness, then those at the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..closures import narrow_lobes
from ..closures.closure_table import LightGrid, grid_for, light_grid, view_cosines
from ..closures.lobes import ggx
from ..common.progress import Progress, portion
from ..kinds.bases import PrincipledBase
from ..kinds.boundaries import Interface
from ..kinds.table import METAL, PREFIX, PRINCIPLED, ROUGHNESS_ROWS, THROWN_BACK
from ..material.stack import Stack
from ..solver.solve import thread_pool
from . import geometric_series
from .dropped_weights import folded
from .mixture import Effort, Mixture, mix, norms, values_of
from .slices import Slices, SolvedRows, along_rows, slices, solve_rows

# Widths of closures for lobes that the layers broaden, beside those of the dictionary.
BROADENED = tuple(f"ggx:{alpha:g}" for alpha in (0.15, 0.22, 0.32, 0.45))
# From this width on, the difference between the attenuated lobe and w times the lobe is fitted too, and counts in the
# report. The light grid does not resolve narrower lobes, whose lights have nearly one cosine.
BROAD = 0.05
# A rest below this share of the albedo is rounding, as in the row without layers.
NEGLIGIBLE = 1e-5
# Colors over which errors are weighed in the choice of closures for a color input. Black is not among them: over a
# black metal there is so little light that its errors alone would decide.
COLORS = (0.05, 0.5, 0.95)
# With roughness as an input, only these rows of thickness are solved, unless a larger stride was asked for; the others
# are interpolated. At grazing views, thin layers change fastest.
ROUGH_ROWS = {"preview": (0, 2, 6, 12, 18, 25, 32), "final": (0, 1, 3, 6, 9, 12, 15, 18, 21, 25, 29, 32)}
ROUGH_STRIDE = {"preview": 6, "final": 3}


def is_shown(stack: Stack) -> bool:
    """True for a Principled base below media of the index of air, where the group holds the BSDF itself."""
    return isinstance(stack.base, PrincipledBase) and not any(isinstance(layer, Interface) for layer in stack.layers)


@dataclass(frozen=True)
class _Rests:
    """The rests of one metallic value: for the own color, or for black; and what a color adds. `whole2`: squared norms
    of V, [color, side, row, channel, column], for the own color or at each of COLORS. `thrown_back`: r, [side, row,
    channel, column]."""

    dark: Slices
    whole2: np.ndarray
    added: Slices | None = None
    thrown_back: np.ndarray | None = None


@dataclass(frozen=True)
class _Work:
    """What all variants of a stack share. `rows`: those of thickness that are solved, or None for every `stride`-th."""

    stack: Stack
    base: PrincipledBase
    quality: str
    threads: int
    stride: int
    rows: tuple[int, ...] | None
    nodes: int | None
    grid: LightGrid
    pool: object

    def at(self, roughness: float) -> _Work:
        """The same work for another roughness."""
        return replace(self, base=replace(self.base, roughness=roughness))

    def solved(self, metallic: float, color, step: Progress) -> tuple[SolvedRows, SolvedRows]:
        """(the stack, the bare base) with other values."""
        base = replace(self.base, metallic=metallic, color=color, inputs=())
        layered = self.stack.with_facets(self.stack.layers, base)
        steps = portion(step, 0.0, 0.9), portion(step, 0.9, 1.0)
        return (solve_rows(layered, self.quality, self.threads, steps[0], self.stride, self.nodes, self.rows),
                solve_rows(Stack([], base), self.quality, self.threads, steps[1], 1, self.nodes))

    def rest(self, solved: SolvedRows, bare: SolvedRows, weight: np.ndarray, step: Progress) -> tuple[Slices, Slices]:
        """(the rest V - w V0, V)."""
        seen = slices(solved, self.grid, self.pool, step)["reflection"]
        clean = slices(bare, self.grid, self.pool, lambda *_: None)["reflection"]
        clean = _of_channels(clean, seen.albedo.shape[2])
        w = weight[None, :, None, :]
        values = seen.values - w[..., None] * clean.values
        if seen.lobes is not None and self.base.alpha < BROAD:
            values = values - seen.lobes + w[..., None] * clean.lobes
        albedo = seen.whole - w * clean.whole
        albedo = np.where(albedo > NEGLIGIBLE * seen.whole, albedo, 0.0)
        return Slices(np.where(albedo[..., None] > 0.0, values, 0.0), albedo, None, np.zeros_like(albedo)), seen


def parts(stack: Stack, quality: str, threads: int, step: Progress, stride: int, nodes: int | None,
          given: dict[str, list[str]], counts: tuple[int, int, int, int], search: dict):
    """(parts of the table by kind, the solved rows, the roughnesses of the table's axis, the slices at the base's own
    values if it has no inputs, or None). `counts`: largest numbers of closures, see bake.Basis. Raises StackError."""
    base = stack.base
    assert isinstance(base, PrincipledBase)
    roughnesses = roughness_rows() if "roughness" in base.inputs else [base.roughness]
    few = stack.varying is not None and len(roughnesses) > 1 and stride < ROUGH_STRIDE[quality]
    rows = ROUGH_ROWS[quality] if few else None
    grid = grid_for(quality, None, narrow_lobes.has_halo(stack))
    work = _Work(stack, base, quality, threads, stride, rows, nodes, grid, thread_pool(threads))
    ends = (0.0, 1.0) if "metallic" in base.inputs else (base.metallic,)
    table: dict[str, Mixture] = {}
    for number, metallic in enumerate(ends):
        prefix = METAL if number else ""
        share = portion(step, number / len(ends), (number + 1) / len(ends))
        found = [_rests(work.at(roughness), metallic, portion(share, 0.7 * k / len(roughnesses),
                                                              0.7 * (k + 1) / len(roughnesses)))
                 for k, roughness in enumerate(roughnesses)]
        solved, weight, rests, values = _joined(found)
        if not number:
            table[PRINCIPLED] = Mixture([PRINCIPLED], _as_strip(weight, rests.dark.albedo.shape))
        fixed, dark, of_dielectric, of_metal = counts
        colored = rests.added is not None
        numbers = (dark, of_metal if metallic > 0.0 else of_dielectric) if colored else (fixed, 0)
        table |= _fitted(work, rests, given, prefix, numbers, search, solved.rows, portion(share, 0.7, 1.0))
    return table, solved, roughnesses if len(roughnesses) > 1 else [], None if base.inputs else values


def roughness_rows() -> list[float]:
    """The roughnesses of a table with a roughness axis."""
    return np.linspace(0.0, 1.0, ROUGHNESS_ROWS).tolist()


def _joined(found: list[tuple]) -> tuple[SolvedRows, np.ndarray, _Rests, Slices]:
    """Results of _rests for several roughnesses, one after the other along the axis of rows."""
    solved, weights, rests, values = zip(*found, strict=True)
    added = [rest.added for rest in rests if rest.added is not None]
    thrown_back = [rest.thrown_back for rest in rests if rest.thrown_back is not None]
    joined = _Rests(along_rows([rest.dark for rest in rests]), np.concatenate([rest.whole2 for rest in rests], axis=2),
                    along_rows(added) if added else None,
                    np.concatenate(thrown_back, axis=1) if thrown_back else None)
    return solved[-1], np.concatenate(weights), joined, values[0]


def _rests(work: _Work, metallic: float, step: Progress) -> tuple[SolvedRows, np.ndarray, _Rests, Slices]:
    """(solved rows, w, the rests, the slices of the stack with its own color or a white one) for one metallic value."""
    if "color" not in work.base.inputs:
        solved, bare = work.solved(metallic, work.base.color, portion(step, 0.0, 0.3))
        weight = attenuations(work.stack, work.base, solved)
        dark, values = work.rest(solved, bare, weight, portion(step, 0.3, 1.0))
        return solved, weight, _Rests(dark, norms(values.values, work.grid)[None] ** 2), values
    solved, bare = work.solved(metallic, 0.0, portion(step, 0.0, 0.1))
    weight = attenuations(work.stack, work.base, solved)
    dark, black = work.rest(solved, bare, weight, portion(step, 0.1, 0.4))
    solved, bare = work.solved(metallic, 1.0, portion(step, 0.4, 0.5))
    light, values = work.rest(solved, bare, weight, portion(step, 0.5, 0.8))
    half = _albedo_of_rest(*work.solved(metallic, 0.5, portion(step, 0.8, 0.9)), weight)
    thrown_back = geometric_series.thrown_back(dark.albedo, half, light.albedo)
    share = 1.0 - thrown_back
    albedo = (light.albedo - dark.albedo) * share
    albedo = np.where(albedo > NEGLIGIBLE * values.whole, albedo, 0.0)
    change = np.where(albedo[..., None] > 0.0, (light.values - dark.values) * share[..., None], 0.0)
    added = Slices(change, albedo, None, np.zeros_like(albedo))
    # V at a color, from V at black and at white, as the rest
    whole2 = [norms(black.values + (color_gain * share)[..., None] * (values.values - black.values), work.grid) ** 2
              for color_gain in _gains(thrown_back)]
    return solved, weight, _Rests(dark, np.array(whole2), added, thrown_back), values


def _gains(thrown_back: np.ndarray) -> np.ndarray:
    """c / (1 - c r) for each of COLORS, [color, side, row, channel, column]."""
    return np.array([geometric_series.gain(color, thrown_back) for color in COLORS])


def _albedo_of_rest(solved: SolvedRows, bare: SolvedRows, weight: np.ndarray) -> np.ndarray:
    """The albedo of V - w V0, [side, row, channel, column], from fluxes alone."""
    mu = view_cosines()
    whole = np.stack([function.reflectance(mu) for function in solved.functions])
    clean = bare.functions[0].reflectance(mu)
    return np.moveaxis(whole - weight[..., None] * clean, 2, 1)[None]


def attenuations(stack: Stack, base: PrincipledBase, solved: SolvedRows) -> np.ndarray:
    """w, [row, column]: of the light that no layer scatters or absorbs on its way to the base's lobe and back, the best
    multiple of the bare lobe (L2 over solid angle). Of channels that differ, the least."""
    mu = view_cosines()
    thickness = np.array([[_thickness(stack, c, row) for c in range(stack.channels)] for row in solved.shares])
    tau = thickness.max(axis=1)[:, None]
    if base.alpha == 0.0:
        return np.exp(-2.0 * tau / mu)
    dense = light_grid(48, 32, 4.0)
    lobe = ggx(base.roughness).evaluate(mu[:, None, None], dense.mu[None, :, None], dense.dphi[None, None, :])
    lobe = (lobe.reshape(len(mu), -1) ** 2 * dense.solid_angle).reshape(len(mu), len(dense.mu), -1).sum(axis=2)
    passed = np.exp(-tau[:, :, None] / dense.mu)[:, 0]  # [row, light]
    return np.exp(-tau / mu) * (passed @ lobe.T) / lobe.sum(axis=1)


def _thickness(stack: Stack, index: int, share: float) -> float:
    """The optical thickness of all layers in one channel, with this share of the varying layer."""
    taus = [stack.optics(number, index)[1] for number in range(len(stack.layers))]
    return float(sum(tau * (share if number == stack.varying else 1.0) for number, tau in enumerate(taus)))


def _of_channels(clean: Slices, channels: int) -> Slices:
    """Slices of the bare base, whose channels may be fewer than the stack's."""
    def spread(part):
        return None if part is None else np.broadcast_to(part, (*part.shape[:2], channels, *part.shape[3:]))

    return Slices(spread(clean.values), spread(clean.albedo), spread(clean.lobes), spread(clean.direct))


def _as_strip(weight: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """w as weights [side, closure, row, channel, column]."""
    sides, rows, channels, columns = shape
    return np.broadcast_to(weight[None, None, :, None, :], (sides, 1, rows, channels, columns))


def _inverse(values: np.ndarray) -> np.ndarray:
    """1 / values, and 0 where these are 0."""
    return np.divide(1.0, values, out=np.zeros_like(values), where=values > 0.0)


def _rows_of_choice(thicknesses: Sequence[int], rows: int, stride: int) -> list[int]:
    """The rows for the choice of closures: about every `stride`-th thickness and the last, at each roughness.
    `thicknesses`: those that were solved, as rows of the table; `rows`: of all roughnesses."""
    count = len(thicknesses)
    kept = {int(np.abs(np.asarray(thicknesses) - row).argmin()) for row in range(stride, thicknesses[-1] + 1, stride)}
    return sorted(first + row for first in range(0, rows, count) for row in {*kept, count - 1})


def _fitted(work: _Work, rests: _Rests, given: dict[str, list[str]], prefix: str, counts: tuple[int, int],
            search: dict, thicknesses: Sequence[int], step: Progress) -> dict[str, Mixture]:
    """The parts of the table by kind, with closures fitted to the rests of one metallic value. Errors of the choice are
    relative to all light of the stack, in the root mean square over colors: of thin layers the rest is a small part,
    and its error too."""
    def fit(wanted: Slices, weight: np.ndarray, count: int, names: Sequence[str], step: Progress) -> Mixture:
        effort = Effort(0, count, count, **search)
        fitted = mix("reflection", wanted, work.grid, effort, work.pool, step, made=made, given=names,
                     whole=np.sqrt(_inverse(weight)), rows=rows)
        return folded(fitted, wanted, work.grid, False)

    made = [*BROADENED, *narrow_lobes.halos(work.stack)]
    rows = _rows_of_choice(thicknesses, rests.dark.albedo.shape[1], search["row_stride"])
    inverse = _inverse(rests.whole2)
    dark = fit(rests.dark, inverse.mean(axis=0), counts[0], given[prefix or "reflection"], portion(step, 0.0, 0.6))
    found = {prefix or "reflection": Mixture([prefix + name for name in dark.closures], dark.weights)}
    if rests.added is not None:
        assert rests.thrown_back is not None
        gains = _gains(rests.thrown_back)
        weight = (gains**2 * inverse).mean(axis=0)
        # The fit over black misses the light e, at all colors. The closures for the light that a color c adds, whose
        # factor is g(c), are fitted to that light and s e, with the s of the least sum of |e - s g e|^2 / |V|^2
        share = (gains * inverse).mean(axis=0) * _inverse(weight)
        missed = rests.dark.values - values_of(dark, work.grid)
        lit = rests.added.albedo > 0.0
        wanted = replace(rests.added, values=rests.added.values + (share * lit)[..., None] * missed)
        added = fit(wanted, weight, counts[1], given[prefix + PREFIX if prefix else "base"], portion(step, 0.6, 1.0))
        found[prefix + PREFIX] = Mixture([prefix + PREFIX + name for name in added.closures], added.weights)
        found[prefix + THROWN_BACK] = Mixture([prefix + THROWN_BACK], rests.thrown_back[:, None])
    return found

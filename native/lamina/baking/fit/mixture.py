# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures of closures: choosing a few for a whole material, and fitting their weights to its slices.

The lobes of rough boundaries are fitted first and alone, by closures made for them; their height would otherwise
dominate the fit of the rest. The remainder, smooth light and the small error of the lobes' fit, is then fitted by
closures of all kinds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...closures import lobes, shaped_lobes
from ...closures.closure_table import Closures, LightGrid, only, view_cosines, with_more
from ...common.progress import Progress, portion
from ...kinds.table import OWN, SHAPE, TILT, Strip
from .slices import Slices, batches

# The objective's factor for a Principled BSDF, which renders slower and noisier than the other closures.
PRINCIPLED_PENALTY = 1.1
# No more closures are added when the mean error of the slices is below this.
ACCURATE = 5e-3
# Closures that are available at every view.
EVERYWHERE = {"reflection": "diffuse", "transmission": "translucent"}
# If the remainder is below this share of the albedo everywhere, it is not fitted separately.
NEGLIGIBLE = 2e-3
# Least numbers of closures beside fixed ones, for lobes and for the remainder; least number for the remainder.
LOBES_BESIDE_FIXED, BESIDE_FIXED, LEAST_REST = 1, 3, 2
# A channel with less than this share of the brightest one's light is too dark for its own errors to be seen.
LEAST_SHOWN = 0.02


@dataclass(frozen=True)
class Effort:
    """The effort of a fit. `lobes`, `rest`, `all`: largest numbers of closures for lobes, for the remainder, and for
    both. `overshoot`: closures that are added beyond these limits and then dropped. `exchanges`: rounds of exchange.
    The choice uses every `column_stride`-th column and `row_stride`-th row; the fit uses all."""

    lobes: int
    rest: int
    all: int
    overshoot: int
    exchanges: int
    column_stride: int
    row_stride: int


@dataclass(frozen=True)
class Mixture:
    """Closures, their `weights` [side, closure, row, channel, column], and the errors of the fit, [side, row, channel,
    column]: `errors`, relative to each slice's norm and nan where the slice is black; `albedo_errors`, relative.
    `shapes` [side, lobe, row, numbers, column]: of the first closures, those that move with the view, see
    closures.shaped_lobes; None without them. `azimuths` [row]: of the viewer from the layer's tangent, if the stack is
    anisotropic. With `thicknesses` above 1, each row of `shapes` and `azimuths` stands for so many rows."""

    closures: list[str]
    weights: np.ndarray
    errors: np.ndarray
    albedo_errors: np.ndarray
    shapes: np.ndarray | None = None
    azimuths: np.ndarray | None = None
    thicknesses: int = 1

    def at_azimuth(self, index: int) -> Mixture:
        """All thicknesses of one of the azimuths."""
        assert self.shapes is not None and self.azimuths is not None
        rows, one = slice(index * self.thicknesses, (index + 1) * self.thicknesses), slice(index, index + 1)
        return replace(self, weights=self.weights[:, :, rows], errors=self.errors[:, rows],
                       albedo_errors=self.albedo_errors[:, rows], shapes=self.shapes[:, :, one],
                       azimuths=self.azimuths[one])


@dataclass(frozen=True)
class Part:
    """Strips of a table, and their `weights` [side, strip, row, channel, column]."""

    strips: list[Strip]
    weights: np.ndarray

    @classmethod
    def of(cls, closures: Sequence[str], weights: np.ndarray, role: str = OWN, metal: bool = False) -> Part:
        """The weights of these closures."""
        return cls([Strip(name, role, metal) for name in closures], weights)

    @classmethod
    def shapes_of(cls, mixture: Mixture) -> list[Part]:
        """The strips for the shapes of its closures that move with the view, if it has any."""
        if mixture.shapes is None:
            return []
        names = mixture.closures[:mixture.shapes.shape[1]]
        shapes = np.repeat(mixture.shapes, mixture.thicknesses, axis=2)
        first, more = shapes[:, :, :, :3], shapes[:, :, :, 3:]
        parts = [cls([Strip(name, SHAPE) for name in names], first)]
        if mixture.azimuths is not None:
            more = np.concatenate([more, np.zeros_like(more[:, :, :, :1])], axis=3)
            parts.append(cls([Strip(name, TILT) for name in names], more))
        return parts

    @classmethod
    def single(cls, strip: Strip, values: np.ndarray) -> Part:
        """One strip with `values` [side, row, channel, column]."""
        return cls([strip], values[:, None])


def mix(kind: str, wanted: Slices, grid: LightGrid, effort: Effort, pool, step: Progress, *, made: Sequence[str] = (),
        given: Sequence[str] = (), mixed: bool = False, fixed: Sequence[str] = (),
        whole: np.ndarray | None = None, rows: Sequence[int] | None = None) -> Mixture:
    """Chooses closures of a kind, from the dictionary and from those `made` for the lobes of boundaries, and fits them
    to all slices. `given` closures are fitted without a choice; all of them are ignored if one was made for other
    lobes, or if they leave a view without a closure. `mixed`: the material both reflects and transmits. `fixed`
    closures are part of every choice, which may then hold a few more. `whole` [side, row, channel, column]: the norms
    that errors of the choice are relative to, where the slices are only a part of the light; by default those of the
    slices. `rows`: those of the choice, by default every `effort.row_stride`-th."""
    given = list(given) if all(":" not in name or name in made for name in given) else []
    choice = _Choice(kind, grid, effort, pool, step, tuple(made), mixed, fixed, whole, rows)
    values, albedo = wanted.values, wanted.albedo
    parts, share = [], 1.0
    left = errors = np.ones(albedo.shape)

    # Fit the lobes of rough boundaries
    if made and wanted.lobes is not None and np.any(wanted.lobes):
        own = [name for name in given if name in made][:effort.lobes]
        found = _fit_lobes(wanted, choice, own)
        given = [name for name in given if name not in own]
        parts.append(found)
        # The remainder is fitted next; errors are relative to the whole slices
        values, albedo = wanted.values - found.values(), np.maximum(wanted.albedo - found.albedo(), 0.0)
        whole = norms(wanted.values, grid)
        left = norms(values, grid) / np.where(whole > 0.0, whole, np.inf)
        share = max(float(left.mean()), ACCURATE)
    taken = [name for part in parts for name in part.closures]

    # Fit the remainder, unless it is negligible
    if not parts or np.any(albedo > NEGLIGIBLE * wanted.albedo):
        count = max(min(effort.rest, effort.all - len(taken)), LEAST_REST)
        if _serves_all_views(given, grid, mixed):
            names = given
        else:
            names = choice.of(values, albedo, count, lambda name: name not in taken, ACCURATE / share)
        if not _serves_all_views(names, grid, mixed):
            names = [*names, EVERYWHERE[kind]]
        found, errors = _fit(names, values, albedo, grid, mixed, pool, portion(step, 0.5, 1.0))
        parts.append(found)
    errors = errors * left

    # Join both parts, and compare their directional albedo with the exact one
    reached = sum(part.albedo() for part in parts)
    exact = wanted.albedo > 0.0
    return Mixture(
        [name for part in parts for name in part.closures],
        np.concatenate([part.weights for part in parts], axis=1),
        np.where(exact, errors, np.nan),
        np.abs(reached - wanted.albedo) / np.maximum(wanted.albedo, 1e-12) * exact,
    )


@dataclass
class _Choice:
    """Choices of closures for one kind of light; the arguments are those of `mix`."""

    kind: str
    grid: LightGrid
    effort: Effort
    pool: _core.ThreadPool
    step: Progress
    made: tuple[str, ...]
    mixed: bool
    fixed: Sequence[str]
    whole: np.ndarray | None
    rows: Sequence[int] | None

    def of(self, values, albedo, count: int, allowed, accurate: float, for_lobes: bool = False) -> list[str]:
        """At most `count` closures for these slices, or more beside fixed ones. `allowed(name)`: true if a closure may
        be chosen; no more are added when the mean error is below `accurate`."""
        self.step(0.0 if for_lobes else 0.1, "Choosing closures")
        basis = with_more(self.kind, self.grid, self.mixed, self.effort.column_stride, self.made)
        candidates = [k for k, name in enumerate(basis.ids) if allowed(name)]
        kept = [k for k in candidates
                if basis.ids[k] in self.fixed and (basis.ids[k] in self.made or not for_lobes)]
        if kept:
            beside = LOBES_BESIDE_FIXED if for_lobes else min(BESIDE_FIXED, count)
            count = min(max(count, len(kept) + beside), _core.MAX_CLOSURES)
        return self._choose(basis, values, albedo, count, candidates, kept, accurate)

    def _choose(self, basis: Closures, values, albedo, count: int, candidates, fixed, accurate: float) -> list[str]:
        """The closures, including `fixed`, that fit all slices best: one choice for the whole material."""
        last, effort = albedo.shape[1] - 1, self.effort
        rows = sorted({*range(0, last, effort.row_stride), last}) if self.rows is None else list(self.rows)
        stride = effort.column_stride
        targets = _targets(basis, values[:, rows, :, ::stride], albedo[:, rows, :, ::stride], self.pool)
        if self.whole is not None:
            for target, whole in zip(targets, self.whole[:, rows, :, ::stride].ravel(), strict=True):
                target.weight = target.norm2 / whole**2 if whole > 0.0 else 0.0
        targets = [target for target in targets if target.norm2 > 0.0]
        if not targets:
            return [basis.ids[candidates[0]]]
        options = selection(basis.ids, count, effort.overshoot, effort.exchanges, accurate)
        options.closures = min(count, len(candidates))
        return [basis.ids[k] for k in basis.table.select(targets, options, candidates, fixed, self.pool).closures]


def selection(names: Sequence[str], count: int, overshoot: int, exchanges: int,
              accurate: float) -> _core.SelectionOptions:
    """The core's options for a choice of at most `count` of the closures `names`, see Effort."""
    options = _core.SelectionOptions()
    options.closures = min(count, len(names), _core.MAX_CLOSURES)
    options.overshoot, options.swap_passes, options.target_error = overshoot, exchanges, accurate
    principled = [lobes.by_id(name).node.type == "ShaderNodeBsdfPrincipled" for name in names]
    options.penalty = [PRINCIPLED_PENALTY if slow else 1.0 for slow in principled]
    return options


def _fit_lobes(wanted: Slices, choice: _Choice, own: list[str]) -> _Fitted:
    """The lobes of rough boundaries, fitted by closures `own`, or by a choice where that is empty."""
    grid, mixed, count = choice.grid, choice.mixed, choice.effort.lobes
    values, albedo = wanted.lobes, np.minimum(wanted.lobes @ grid.solid_angle, wanted.albedo)
    # A greedy choice among more closures is not always better: make both choices, and take the better fit.
    step = portion(choice.step, 0.0, 0.1)
    chosen = [own] if own else [choice.of(values, albedo, count, lambda name: name in choice.made, ACCURATE, True),
                                choice.of(values, albedo, count, lambda _: True, ACCURATE, True)]
    found, _ = min((_fit(names, values, albedo, grid, mixed, choice.pool,
                         portion(step, number / len(chosen), (number + 1) / len(chosen)))
                    for number, names in enumerate(chosen)),
                   key=lambda fitted: float(fitted[1].mean()))
    return found


def reweighted(mixture: Mixture, weights: np.ndarray, wanted: Slices, grid: LightGrid,
               mixed: bool) -> Mixture:
    """The mixture with other weights, its errors measured again where these changed. The albedo errors of the fit are
    kept."""
    changed, errors = replace(mixture, weights=weights), mixture.errors.copy()
    rows = weights.shape[2]
    for index, some in enumerate(batches(rows, rows if mixture.azimuths is None else mixture.thicknesses)):
        columns = np.flatnonzero(np.any(weights[:, :, some] != mixture.weights[:, :, some], axis=(0, 1, 2, 3)))
        if columns.size:
            part = changed if mixture.azimuths is None else changed.at_azimuth(index)
            seen = wanted.values[:, some][:, :, :, columns]
            left = norms(seen - values_of(part, grid, mixed, columns), grid)
            errors[:, some][..., columns] = relative(left, norms(seen, grid))
    return replace(changed, errors=np.where(wanted.albedo > 0.0, errors, np.nan))


def values_of(mixture: Mixture, grid: LightGrid, mixed: bool = False, columns=slice(None)) -> np.ndarray:
    """The values of a mixture, [side, row, channel, column, light], at all columns or some."""
    moving = 0 if mixture.shapes is None else mixture.shapes.shape[1]
    fixed = mixture.closures[moving:]
    basis = [only(grid, mixed, tuple(fixed)).values[columns]] if fixed else []  # [column, closure, light]
    weights = mixture.weights[..., columns]
    if mixture.shapes is None:
        return np.einsum("skrxc,ckl->srxcl", weights, basis[0], optimize=True)
    found = []
    for row, part in enumerate(batches(weights.shape[2], mixture.thicknesses)):
        turn = None if mixture.azimuths is None else mixture.azimuths[row]
        lobes = [shaped_lobes.sampled(shape.T[columns], view_cosines()[columns], turn, grid)[:, None]
                 for shape in mixture.shapes[0, :, row]]
        every = np.concatenate([*lobes, *basis], axis=1)
        own = weights[0, :, part]
        values = own.reshape(len(own), -1, len(every)).T @ every
        found.append(np.moveaxis(values.reshape(len(every), *own.shape[1:3], -1), 0, 2))
    return np.concatenate(found)[None]


def weighted(weights: np.ndarray, shapes: np.ndarray, grid: LightGrid, stride: int = 1,
             azimuths: np.ndarray | None = None) -> np.ndarray:
    """The values of a lobe that moves with the view, [side, row, channel, column, light], for weights [side, row,
    channel, column] and shapes [side, row, column, numbers] at every `stride`-th view; `azimuths` [row]: see
    Mixture."""
    mu_o = view_cosines()[::stride]
    turns = [None] * shapes.shape[1] if azimuths is None else azimuths.tolist()
    lobes = np.stack([[shaped_lobes.sampled(row, mu_o, turn, grid) for row, turn in zip(side, turns, strict=True)]
                      for side in shapes])
    return weights[..., None] * lobes[:, :, None]


def albedos_of(mixture: Mixture, grid: LightGrid, mixed: bool) -> np.ndarray:
    """Directional albedos of the closures of unit weight, [side, closure, row, column]; axes may have the size 1."""
    moving = 0 if mixture.shapes is None else mixture.shapes.shape[1]
    parts = []
    if fixed := mixture.closures[moving:]:
        parts.append(only(grid, mixed, tuple(fixed)).albedo.T[None, :, None])
    if mixture.shapes is not None:
        azimuths = None if mixture.azimuths is None else mixture.azimuths[:, None]
        moving_albedo = shaped_lobes.albedos(np.moveaxis(mixture.shapes, 3, 4), view_cosines(), azimuths)
        parts.insert(0, np.repeat(moving_albedo, mixture.thicknesses, axis=2))
        parts = [np.broadcast_to(part, (*parts[0].shape[:1], part.shape[1], *parts[0].shape[2:])) for part in parts]
    return np.concatenate(parts, axis=1)


class _Fitted:
    """Weights [side, closure, row, channel, column] of closures, and the sums of the weighted closures."""

    def __init__(self, basis: Closures, weights: np.ndarray):
        self.closures = basis.ids
        self.weights = weights
        self._basis = basis

    def values(self) -> np.ndarray:
        """[side, row, channel, column, light]."""
        return np.einsum("skrxc,ckl->srxcl", self.weights, self._basis.values, optimize=True)

    def albedo(self) -> np.ndarray:
        """[side, row, channel, column], of weights as the table stores them."""
        return np.einsum("skrxc,ck->srxc", self.weights.astype(np.float32), self._basis.albedo)


def _fit(names: Sequence[str], values, albedo, grid: LightGrid, mixed: bool, pool, step: Progress):
    """(fitted closures, errors relative to the norm of `values` [side, row, channel, column])."""
    basis, chosen, rows = only(grid, mixed, tuple(names)), list(range(len(names))), albedo.shape[1]
    made = []
    for part in batches(rows):
        step(part.start / rows, f"Fitting thickness {part.start + 1} of {rows}")
        exact = albedo[:, part]
        weights, errors = basis.table.fit(_targets(basis, values[:, part], exact, pool), chosen, pool)
        made.append((weights.reshape(*exact.shape, len(names)), errors.reshape(exact.shape)))
    weights, errors = (np.concatenate(parts, axis=1) for parts in zip(*made, strict=True))
    black = albedo <= 0.0
    weights = np.where(black[..., None], 0.0, weights)
    return _Fitted(basis, np.moveaxis(weights, -1, 1)), np.where(black, 1.0, errors)


def _serves_all_views(names: Sequence[str], grid: LightGrid, mixed: bool) -> bool:
    """True if each view has a closure: in sheets not all closures are available at every view."""
    return bool(names) and bool(np.all(only(grid, mixed, tuple(names)).albedo.max(axis=1) > 1e-3))


def _targets(basis: Closures, values: np.ndarray, albedo: np.ndarray, pool):
    """The core's targets of all slices, with all axes except columns flattened."""
    columns = albedo.shape[3]
    flat = np.ascontiguousarray(values).reshape(-1, columns, values.shape[-1])
    return basis.table.targets(flat, np.ascontiguousarray(albedo).reshape(-1, columns), pool)


def norms(values: np.ndarray, grid: LightGrid) -> np.ndarray:
    """L2 norms over solid angle, along the last axis of `values`."""
    if values.dtype == np.float32:  # of many rows, one after the other
        return np.stack([norms(row.astype(float), grid) for row in np.moveaxis(values, 1, 0)], axis=1)
    return np.sqrt(np.maximum((values**2) @ grid.solid_angle, 0.0))


def mean_error(errors: np.ndarray) -> float:
    """Mean over the slices that are not black; 0 when all are."""
    seen = errors[np.isfinite(errors)]
    return float(seen.mean()) if seen.size else 0.0


def seen_errors(errors: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Errors of slices [side, row, channel, column] relative to their light `whole`, norms or albedos; in a channel
    that is darker than LEAST_SHOWN times the brightest one, relative to LEAST_SHOWN times the light of that one.
    Saturated pigments leave channels without visible light."""
    least = LEAST_SHOWN * whole.max(axis=2, keepdims=True)
    return errors * np.minimum(np.divide(whole, least, out=np.ones_like(whole), where=least > 0.0), 1.0)


def relative(error: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Errors of slices relative to their norms `whole`; nan where a slice is black."""
    return np.where(whole > 0.0, error / np.where(whole > 0.0, whole, 1.0), np.nan)


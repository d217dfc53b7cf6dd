# SPDX-License-Identifier: GPL-3.0-or-later
"""Invariants that hold for all stacks: each function returns one sentence per violation."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import numpy as np
from z_limit import z_limit

import lamina
from lamina import Conductor, Fibers, Film, Flakes, Interface, Medium, PrincipledBase, Retroreflector, Stack
from lamina.solver.core_calls import tolerance_of

QUALITY = "preview"
TOLERANCE = tolerance_of(QUALITY)
MU = np.array([0.05, 0.13, 0.37, 0.62, 0.88, 1.0])
DPHI = np.array([0.0, 0.4, 1.3, 2.4, math.pi])
# In stacks with boundaries, the tolerance of lamina.solve is relative to the largest of three numbers: the value, this
# share of the value's mean over azimuths, and this value in 1/sr.
FAINT = 1e-3
ENERGY = 1e-4  # largest gain of a rough boundary that the solver allows
WALK_SAMPLES = 1 << 16
WALK_POINTS = 3


def grids(solved) -> dict:
    """BRDF and, for sheets with air below, BTDF from both sides, [o, i, dphi, channel], by (path, side)."""
    sights = [("reflect", "top")]
    if solved.stack.base is None and ends_in_air(solved.stack):
        sights += [("reflect", "bottom"), ("transmit", "top"), ("transmit", "bottom")]
    return {sight: solved.grid(sight[0], MU, MU, DPHI, side=sight[1]) for sight in sights}


def ends_in_air(stack: Stack) -> bool:
    indices = [layer.ior for layer in stack.layers if isinstance(layer, Interface)]
    return stack.base is not None or not indices or indices[-1] == 1.0


def of_values(stack: Stack, found: dict) -> list[str]:
    """Values are finite, not negative, and reciprocal except over a Principled base, whose law is not."""
    wrong = []
    for (path, side), f in found.items():
        if not np.all(np.isfinite(f)):
            wrong.append(f"{path} {side}: not finite")
            continue
        negative = float((-f / promised(f, stack)).max())
        if negative > TOLERANCE:
            wrong.append(f"{path} {side}: negative by {negative:.2g} of what the tolerance is relative to")
        other = f if path == "reflect" else found[path, "bottom" if side == "top" else "top"]
        off = difference(f, np.moveaxis(other, 0, 1), stack)
        if off > 1e-6 and not isinstance(stack.base, PrincipledBase):
            wrong.append(f"{path} {side}: reciprocity broken by {off:.2g}")
    return wrong


def of_energy(solved) -> list[str]:
    """Energy does not grow, and is conserved in stacks without absorption."""
    wrong = []
    for side in ("top", "bottom") if solved.stack.base is None and ends_in_air(solved.stack) else ("top",):
        for mu0 in (MU, "diffuse"):
            whole = solved.reflectance(mu0, side) + solved.transmittance(mu0, side)
            if not np.all(np.isfinite(whole)):
                wrong.append(f"energy {side}: not finite")
            elif whole.max() > 1.0 + ENERGY:
                wrong.append(f"energy {side}: {whole.max() - 1.0:.2g} gained")
            elif _keeps_all(solved.stack) and whole.min() < 1.0 - ENERGY:
                wrong.append(f"energy {side}: {1.0 - whole.min():.2g} lost by a stack that absorbs nothing")
    return wrong


def of_splitting(stack: Stack, found: dict, chance: random.Random) -> list[str]:
    """Dividing a homogeneous layer in two does not change the result."""
    whole = [k for k, layer in enumerate(stack.layers) if isinstance(layer, Flakes | Fibers) or (
        isinstance(layer, Medium) and layer.profile is None and layer.color is None and not layer.varying)]
    if not whole:
        return []
    k, share = chance.choice(whole), chance.choice([0.5, chance.uniform(0.01, 0.99)])
    layer = stack.layers[k]
    names = ("tau", "binder") if isinstance(layer, Flakes) else ("tau" if layer.tau is not None else "thickness",)

    def part(of):
        sizes = {name: getattr(layer, name) for name in names}
        return replace(layer, **{name: tuple(of * x for x in size) if isinstance(size, tuple) else of * size
                                 for name, size in sizes.items()})

    layers = [*stack.layers[:k], part(share), part(1.0 - share), *stack.layers[k + 1:]]
    try:
        divided = grids(lamina.solve(Stack(layers, stack.base), QUALITY, threads=1))
    except lamina.SolveError as error:
        return [f"layers[{k}] divided at {share:.2g}: refused, {error}"]
    return _apart(divided, found, stack, f"layers[{k}] divided at {share:.2g}")


def of_thickness(solved, chance: random.Random) -> list[str]:
    """Changing the thickness of a solved layer gives the same result as a new solve with that thickness."""
    whole = [k for k, layer in enumerate(solved.stack.layers) if isinstance(layer, Medium) and layer.tau is not None
             and layer.profile is None and layer.color is None]
    if not whole:
        return []
    k, tau = chance.choice(whole), math.exp(chance.uniform(math.log(1e-6), math.log(10.0)))
    layers = list(solved.stack.layers)
    layers[k] = replace(layers[k], tau=tau)
    anew = Stack(layers, solved.stack.base)
    try:
        fresh = grids(lamina.solve(anew, QUALITY, threads=1))
    except lamina.SolveError:
        return []
    try:
        grown = grids(solved.with_thickness(k, tau))
    except lamina.SolveError as error:
        return [f"layers[{k}] given tau {tau:.2g}: refused, {error}"]
    return _apart(grown, fresh, anew, f"layers[{k}] given tau {tau:.2g}, against a new solve")


def of_walks(solved, found: dict, chance: random.Random, comparisons: int) -> list[str]:
    """Photon walks agree with the solver at some points, by Z-scores at a family-wise level of 1 %."""
    if not ends_in_air(solved.stack):
        return []
    limit = z_limit(comparisons)
    wrong = []
    for _ in range(WALK_POINTS):
        path, side = chance.choice(list(found))
        o, i, p = chance.randrange(1, len(MU)), chance.randrange(1, len(MU)), chance.randrange(len(DPHI))
        value = found[path, side][o, i, p]
        walk = lamina.estimate(solved.stack, MU[o], MU[i], DPHI[p], "transfer", WALK_SAMPLES, seed=chance.randrange(
            1 << 30), threads=1, side=side, path=path)
        allowed = TOLERANCE * promised(found[path, side], solved.stack)[o, i, p]
        z = (np.abs(value - walk.value) - allowed) / np.maximum(walk.stderr, 1e-300)
        if np.any(z > limit):
            c = int(z.argmax())
            wrong.append(f"{path} {side} at {MU[o]}, {MU[i]}, {DPHI[p]:.2f}: {value[c]:.4g}, the walk says "
                         f"{walk.value[c]:.4g} +- {walk.stderr[c]:.1g}")
    return wrong


def of_table(lut) -> list[str]:
    """The weights of a baked table are finite and not negative, and its errors are plausible."""
    wrong = []
    if not np.all(np.isfinite(lut.weights)) or lut.weights.min() < 0.0:
        wrong.append("table: weights negative or not finite")
    if not all(math.isfinite(lut.report[name]) for name in ("fit_error", "albedo_error", "energy_error")):
        wrong.append("table: an error in the report is not finite")
    return wrong


def promised(f: np.ndarray, stack: Stack) -> np.ndarray:
    """The reference of the relative tolerance, [o, i, dphi, channel]. In stacks of media alone the reference is the
    value, or the rounding noise of the largest value."""
    value = np.abs(f)
    if any(isinstance(layer, Interface | Flakes | Fibers) for layer in stack.layers) or isinstance(
            stack.base, Conductor | Retroreflector):
        steps = np.diff(DPHI)[:, None]
        mean = (0.5 * (value[:, :, 1:] + value[:, :, :-1]) * steps).sum(axis=2, keepdims=True) / math.pi
        return np.maximum(value, FAINT * np.maximum(mean, 1.0))
    return value + 1e-12 * value.max() + 1e-300


def difference(a: np.ndarray, b: np.ndarray, stack: Stack) -> float:
    """The largest difference relative to the reference of the tolerance."""
    return float((np.abs(a - b) / promised(b, stack)).max())


def _apart(ones: dict, others: dict, stack: Stack, what: str) -> list[str]:
    """Sentences about the grids of two solves of one stack that differ by more than both tolerances."""
    differences = {sight: difference(ones[sight], other, stack) for sight, other in others.items()}
    return [f"{what}: {' '.join(sight)} differs by {off:.2g}" for sight, off in differences.items()
            if off > 2.0 * TOLERANCE]


def _keeps_all(stack: Stack) -> bool:
    surfaces = [layer for layer in stack.layers if isinstance(layer, Interface)]
    if any(isinstance(layer, Flakes | Fibers | Film) for layer in stack.layers):  # films may absorb
        return False
    if any(s.alpha > 0.0 and not s.compensate for s in surfaces) or isinstance(stack.base, Conductor):
        return False
    if not ends_in_air(stack):
        return False
    media = [(index, layer) for index, layer in enumerate(stack.layers) if isinstance(layer, Medium)]
    for index, layer in media:
        if layer.color is not None or layer.profile is not None:
            return False
        if any(albedo < 1.0 or math.isinf(tau) for albedo, tau in map(
                lambda c, k=index: stack.optics(k, c), range(stack.channels))):
            return False
    if isinstance(stack.base, lamina.Lambert):
        reflectance = stack.base.reflectance
        return all(r == 1.0 for r in (reflectance if isinstance(reflectance, tuple) else (reflectance,)))
    return stack.base is None

# SPDX-License-Identifier: GPL-3.0-or-later
"""The perceived colour of a medium, and the albedo that gives a wanted colour.

A medium's colour is its hemispherical reflectance under a white sky (uniform diffuse light from above), without
interfaces. The layer is infinitely thick, or has its own thickness and lies *over* a Lambert surface. The colour is a
strictly increasing function of the albedo, so one albedo gives each colour. The albedo is found with the solver of
bakes."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

from .. import _core
from ..common.arguments import check_kind
from ..common.errors import StackError
from ..kinds.fields import Channels, Field, channel, channel_count
from ..kinds.phases import Isotropic
from .layers import Medium
from .phase import Phase

EXACT = 6e-6  # largest relative error of a shown colour, estimated by doubling the nodes
FEW_NODES, MOST_NODES = 8, 256
ALBEDOS = (0.05, 0.6, 0.95)  # at which the error is estimated


def shown(medium: Medium, over: Channels | None = None) -> list[float]:
    """The colour, one value per channel, of an infinitely thick layer of `medium`; or, with `over` (the reflectance of
    a Lambert surface, [0, 1]), of a layer of its own thickness on that surface. Raises StackError, also for a medium
    with a profile or a pigment, and ArgumentError."""
    medium = check_kind(medium, "medium", Medium, "a lamina.Medium").checked("medium")
    if medium.pigment is not None:
        raise StackError("medium.pigment: must be in a Stack, which has wavelengths")
    if medium.profile is not None:
        raise StackError("medium.profile: must be left out, a medium has one colour")
    over = None if over is None else _field("over").check(over, "over")
    count = _channels(medium, "medium", ("over", over))
    check_colours(medium, count, "medium")
    albedos = albedos_of(medium, count) if medium.color is not None else None
    seen = replace(medium, over=over)
    return [reflected(albedos[index] if albedos else medium.optics(index)[0], *_situation(seen, index))
            for index in range(count)]


def albedo_of(color: Channels, phase: Phase | None = None, tau: Channels = math.inf,
              over: Channels | None = None) -> list[float]:
    """The albedo, one value per channel, for which a medium of this phase function (default: isotropic) has the colour
    `color`: as an infinitely thick layer, or, with `over`, as a layer of optical thickness `tau` on a Lambert surface
    of that reflectance. Colours 0 and 1 of an infinitely thick layer have albedo 0 and 1. Raises StackError, with the
    possible range, for a colour that no albedo gives."""
    phase = Isotropic() if phase is None else phase
    medium = Medium(color=color, tau=tau, over=over, phase=phase).checked("medium")
    count = _channels(medium, "medium")
    check_colours(medium, count, "medium")
    return list(albedos_of(medium, count))


def check_colours(medium: Medium, channels: int, path: str) -> None:
    """Raises StackError, naming `path`, if no albedo gives the colour of a checked Medium, or of a knot of its
    profile. Only layers of finite thickness over a surface are solved: infinitely thick layers can have any colour."""
    if medium.color is not None:
        _check_color(medium, channels, path)
    for number, knot in enumerate(medium.profile or ()):
        if knot.color is not None:
            _check_color(_at_knot(medium, number), channels, f"{path}.profile[{number}]")


def albedos_of_layer(medium: Medium, channels: int) -> tuple | None:
    """The albedos of a checked Medium: one per channel if it is given by a colour; for a profile, this or None for
    each knot; else None."""
    if medium.profile is not None:
        return tuple(None if knot.color is None else albedos_of(_at_knot(medium, number), channels)
                     for number, knot in enumerate(medium.profile))
    return None if medium.color is None else albedos_of(medium, channels)


def albedos_of(medium: Medium, channels: int) -> tuple[float, ...]:
    """albedo_of for a checked Medium that is given by a colour within reach."""
    return tuple(albedo_by(channel(medium.color, index), *_situation(medium, index)) for index in range(channels))


def _check_color(medium: Medium, channels: int, path: str) -> None:
    for index in range(channels):
        wanted, situation = channel(medium.color, index), _situation(medium, index)
        low, high = reachable(*situation)
        if not low - 1e-9 <= wanted <= high + 1e-9:
            where = f"{path}.color" + (f"[{index}]" if isinstance(medium.color, tuple) else "")
            # Round inwards, so that the ends given in the message are allowed.
            least, most = math.ceil(low * 1e4) / 1e4, math.floor(high * 1e4) / 1e4
            between = f"between {least:g} and {most:g}" if least < most else f"{round(low, 6):g}"
            _, tau, over = situation
            raise StackError(f"{where} = {wanted:g}: a layer of tau {tau:g} over {over:g} shows {between}")


def _at_knot(medium: Medium, number: int) -> Medium:
    """The homogeneous medium with the colour and the phase function of a knot."""
    assert medium.profile is not None
    knot = medium.profile[number]
    return replace(medium, profile=None, color=knot.color, phase=knot.phase or medium.phase)


def _situation(medium: Medium, index: int) -> tuple:
    """(phase, tau, over) of one channel, for the core; without a surface below, tau is infinite."""
    _, tau = medium.optics(index)
    known = medium.phase.in_channel(index)
    finite = medium.over is not None and tau < math.inf
    return (known, tau, channel(medium.over, index)) if finite else (known, math.inf, 0.0)


def _field(name: str) -> Field:
    return next(quantity for form in Medium.forms for quantity in form if quantity.name == name)


def _channels(medium: Medium, path: str, *more) -> int:
    named = [(f"{path}.{q.name}", getattr(medium, q.name)) for form in Medium.forms for q in form]
    return channel_count([*named, *medium.phase.quantities(f"{path}.phase"), *more])


@lru_cache(maxsize=1)
def _pool() -> _core.ThreadPool:
    return _core.ThreadPool(1)


def _reflectance(albedo: float, phase: tuple, tau: float, over: float, nodes: int) -> float:
    """Reflectance under a white sky, solved with `nodes` nodes. Fluxes need the azimuthal mean only, so the tolerance
    of azimuth orders is wide."""
    stack = _core.Stack([_core.Medium(albedo, tau, *phase)], _core.Base.lambert(over))
    solution = _core.solve_at(stack, nodes, 1.0, _pool(), min(tau, 1.0) or 1.0)
    fluxes = solution.diffuse_fluxes(_core.Side.top, _pool())
    return float(fluxes.reflected[0])


@lru_cache(maxsize=1024)
def _nodes(phase: tuple, tau: float) -> int:
    """The number of nodes for a colour: doubling it changes the colour by less than EXACT."""
    nodes = 2 * FEW_NODES
    while nodes < MOST_NODES:
        pairs = [[_reflectance(albedo, phase, tau, 0.0, n) for n in (nodes, 2 * nodes)] for albedo in ALBEDOS]
        if all(abs(rough - fine) <= EXACT * fine for rough, fine in pairs):
            break
        nodes *= 2
    return nodes


@lru_cache(maxsize=1024)
def reflected(albedo: float, phase: tuple, tau: float, over: float) -> float:
    """The colour of a layer, as checked numbers of one channel; `phase` as the core takes it."""
    if tau == math.inf and albedo in (0.0, 1.0):
        return albedo
    if tau == 0.0:
        return over
    return _reflectance(albedo, phase, tau, over, _nodes(phase, tau))


def reachable(phase: tuple, tau: float, over: float) -> tuple[float, float]:
    """The colours of albedo 0 and 1."""
    return reflected(0.0, phase, tau, over), reflected(1.0, phase, tau, over)


@lru_cache(maxsize=4096)
def albedo_by(wanted: float, phase: tuple, tau: float, over: float) -> float:
    """The albedo for the colour `wanted`, to 12 digits.

    A search with few nodes finds the approximate albedo and the slope there. Steps along this slope then correct the
    remaining error with the number of nodes that the colour needs."""
    low, high = reachable(phase, tau, over)
    if wanted <= low:
        return 0.0
    if wanted >= high:
        return 1.0
    variable = _Variable(phase, tau)
    where, slope = _find_roughly(wanted, phase, tau, over, variable)
    nodes = _nodes(phase, tau)
    before = None
    for _ in range(8):
        miss = _reflectance(variable.albedo(where), phase, tau, over, nodes) - wanted
        if before is not None and where != before[0]:
            slope = (miss - before[1]) / (where - before[0])
        if slope == 0.0:  # the colour no longer changes within its digits
            break
        before = (where, miss)
        where = min(variable.black, max(variable.white, where - miss / slope))
        # The relative error of the slope is at most a fifth.
        if abs(miss) <= 1e-5 * wanted:
            break
    return float(f"{variable.albedo(where):.12g}")


class _Variable:
    """A variable in which colours are nearly linear: the similarity parameter s = sqrt((1 - albedo) / (1 - g albedo))
    for a thick layer (van de Hulst 1980), with a transition to s^2 for a thin layer."""

    def __init__(self, phase: tuple, tau: float):
        self._g = float(_core.PhaseFunction(*phase).moment(1))
        self.white = 1.0 / (1.0 + tau * (1.0 - self._g))  # the value for albedo 1
        self.black = math.hypot(1.0, self.white)  # the value for albedo 0

    def albedo(self, where: float) -> float:
        square = max(0.0, (where - self.white) * (where + self.white))
        return min(1.0, max(0.0, (1.0 - square) / (1.0 - self._g * square)))


def _find_roughly(wanted: float, phase: tuple, tau: float, over: float, variable: _Variable) -> tuple[float, float]:
    """(variable, slope) for a colour on few nodes: false position with the rule of Anderson and Bjorck (1973)."""
    low, high = reachable(phase, tau, over)
    a, at_a, b, at_b = variable.white, high - wanted, variable.black, low - wanted
    where = _endless(wanted) if tau == math.inf else b - at_b * (b - a) / (at_b - at_a)
    last, at_last = (a, at_a) if at_a < -at_b else (b, at_b)
    slope, kept = at_b - at_a, 0
    for _ in range(60):
        miss = _reflectance(variable.albedo(where), phase, tau, over, FEW_NODES) - wanted
        if where != last:
            slope = (miss - at_last) / (where - last)
        if abs(miss) <= 5e-6 * wanted or b - a <= 1e-15:
            break
        last, at_last = where, miss
        if miss > 0.0:
            at_b *= _shrink(miss, at_a) if kept > 0 else 1.0
            a, at_a, kept = where, miss, 1
        else:
            at_a *= _shrink(miss, at_b) if kept < 0 else 1.0
            b, at_b, kept = where, miss, -1
        where = b - at_b * (b - a) / (at_b - at_a)
        if not a < where < b:
            where = 0.5 * (a + b)
    return where, slope


def _shrink(new: float, old: float) -> float:
    """The factor for the value at the end of the bracket that was kept twice."""
    share = 1.0 - new / old
    return share if share > 0.0 else 0.5


def _endless(wanted: float) -> float:
    """Approximate s of a half-space: inverts R = (1 - s)(1 - .139 s) / (1 + 1.17 s) (van de Hulst 1980)."""
    b = 1.139 + 1.17 * wanted
    return (b - math.sqrt(b * b - 4.0 * 0.139 * (1.0 - wanted))) / (2.0 * 0.139)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The medium that shows two colours: over black and over white, the inverse problem of a drawdown card, or as one coat
and as several."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from ..common.arguments import check_number
from ..common.errors import StackError
from ..kinds.fields import Channels, as_channels, channel, channel_count
from ..kinds.media import COLOR
from ..kinds.phases import Isotropic
from .colours import albedo_by, reachable, reflected
from .phase import Phase, check_phase

WHITE = 0.8  # reflectance of the white part of a drawdown card
THINNEST, THICKEST = 1e-6, 1e3
CLOSE = 1e-7  # of the colour over black


class Matched(NamedTuple):
    """albedo and optical thickness tau of a layer, each a number or one per channel."""

    albedo: Channels
    tau: Channels


def match(over_black: Channels, over_white: Channels, phase: Phase | None = None, white: float = WHITE) -> Matched:
    """The albedo and the optical thickness of a layer without interfaces that shows `over_black` on a black surface and
    `over_white` on a Lambert surface of reflectance `white`, under uniform diffuse light: both in [0, 1], a number or
    one per channel, linear. `phase`: its phase function, by default isotropic. If both colours are equal, the layer is
    infinitely thick.

    Over white, each thickness needs one albedo. The colour over black then grows with the thickness, which is found by
    bisection and the secant rule. Raises StackError, with the possible range, for colours that no such layer shows, and
    ArgumentError for `white` outside of [.05, 1]."""
    phase = check_phase(Isotropic() if phase is None else phase, "phase")
    white = check_number(white, "white", "must lie in [0.05, 1]", lambda value: 0.05 <= value <= 1.0)
    dark, bright = COLOR.check(over_black, "over_black"), COLOR.check(over_white, "over_white")
    count = channel_count([("over_black", dark), ("over_white", bright), *phase.quantities("phase")])
    found = [_matched(channel(dark, index), channel(bright, index), phase.in_channel(index), white, index)
             for index in range(count)]
    return Matched(*map(as_channels, zip(*found, strict=True)))


def match_coats(once: Channels, twice: Channels, over: Channels, phase: Phase | None = None,
                times: float = 2.0) -> Matched:
    """The albedo and the optical thickness of a coat without interfaces on a Lambert surface of reflectance `over`,
    which shows `once`, and `twice` where it is `times` as thick, (1, 100]; colours as for `match`. If both are equal,
    the coat is infinitely thick. Each thickness needs one albedo for `once`; the thicker the coat, the less the colour
    changes with more of it. Raises StackError, with the possible range, for colours that no such coat shows."""
    phase = check_phase(Isotropic() if phase is None else phase, "phase")
    times = check_number(times, "times", "must lie in (1, 100]", lambda value: 1.0 < value <= 100.0)
    once, twice, over = COLOR.check(once, "once"), COLOR.check(twice, "twice"), COLOR.check(over, "over")
    count = channel_count([("once", once), ("twice", twice), ("over", over), *phase.quantities("phase")])
    found = [_coated(channel(once, index), channel(twice, index), channel(over, index), phase.in_channel(index), times,
                     index) for index in range(count)]
    return Matched(*map(as_channels, zip(*found, strict=True)))


def _matched(dark: float, bright: float, phase: tuple, white: float, index: int) -> tuple[float, float]:
    if dark > bright:
        raise StackError(f"over_black[{index}] = {dark:g}: must be at most over_white, {bright:g}")
    if dark == bright:
        return albedo_by(bright, phase, math.inf, 0.0), math.inf

    def missing(tau: float) -> float:
        return reflected(_albedo(bright, phase, tau, white), phase, tau, 0.0) - dark

    thinnest = _thinnest(bright, phase, white)
    too_much = missing(thinnest)
    if too_much > CLOSE:
        raise StackError(f"over_black[{index}] = {dark:g}: a layer that shows {bright:g} over {white:g} shows at least "
                         f"{dark + too_much:.4g} over black")
    tau = _root(missing, thinnest)
    return _albedo(bright, phase, tau, white), tau


def _coated(once: float, twice: float, over: float, phase: tuple, times: float, index: int) -> tuple[float, float]:
    if once == twice:
        return albedo_by(once, phase, math.inf, 0.0), math.inf
    brightens = twice > once
    if once == over or brightens != (once > over):
        raise StackError(f"twice[{index}] = {twice:g}: must lie beyond once, {once:g}, as seen from over, {over:g}")

    def missing(tau: float) -> float:
        left = reflected(_albedo(once, phase, tau, over), phase, times * tau, over) - twice
        return -left if brightens else left

    thinnest = _thinnest(once, phase, over)
    too_much = missing(thinnest)
    if too_much > CLOSE:
        bound = f"most {twice - too_much:.4g}" if brightens else f"least {twice + too_much:.4g}"
        raise StackError(f"twice[{index}] = {twice:g}: a coat that shows {once:g} over {over:g} shows at {bound} where "
                         f"it is {times:g} times as thick")
    tau = _root(missing, thinnest)
    return _albedo(once, phase, tau, over), tau


def _albedo(color: float, phase: tuple, tau: float, over: float) -> float:
    """The albedo with which a layer of this thickness shows a colour, or comes closest."""
    low, high = reachable(phase, tau, over)
    return albedo_by(min(max(color, low), high), phase, tau, over)


def _root(missing: Callable[[float], float], thinnest: float) -> float:
    """The thickness from `thinnest` to THICKEST where `missing`, which grows with it, is 0; else THICKEST."""
    low, high = math.log(thinnest), math.log(THICKEST)
    below, above = missing(thinnest), missing(THICKEST)
    if above < 0.0:
        return THICKEST
    log_tau = low
    for number in range(80):
        # Every third step halves the range, in case the secant moves only one of its ends.
        share = 0.5 if number % 3 == 2 or below == above else min(max(below / (below - above), 0.02), 0.98)
        log_tau = low + share * (high - low)
        left = missing(math.exp(log_tau))
        if abs(left) < CLOSE or high - low < 1e-12:
            break
        if left < 0.0:
            low, below = log_tau, left
        else:
            high, above = log_tau, left
    return float(f"{math.exp(log_tau):.9g}")


def _thinnest(color: float, phase: tuple, over: float) -> float:
    """The least thickness at which an albedo gives the colour over a surface."""
    def reaches(tau: float) -> bool:
        low, high = reachable(phase, tau, over)
        return low <= color <= high

    if reaches(THINNEST):
        return THINNEST
    low, high = math.log(THINNEST), math.log(THICKEST)
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reaches(math.exp(middle)) else (middle, high)
    return math.exp(high)

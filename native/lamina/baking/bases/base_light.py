# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that a base adds to the layers over black, as a function of the base's color c:

    dark + c F + c^2 (1 - r) / (1 - c r) W

F is light that the base reflects once, and W what a white base reflects repeatedly, because the layers throw light
back. For a Lambert surface this is exact, with r the share of light that the layers throw back, see geometric_series. A
metal below an interface needs F and W apart: most of its light leaves after one reflection, but light that the
interface traps is reflected many times. F, W and r are chosen for each view so that the albedo is exact at four
colors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...kinds.table import AGAIN, DARK, FIRST
from ..fit.geometric_series import repeated
from ..fit.slices import Slices, joined

# Colors for which a base is solved. Slices are needed for the first three, and the albedo alone for the last.
COLORS = (0.0, 0.125, 1.0, 0.85)
# Shares of the albedo below which light is left out: for the dark base, and for light that a color changes.
NEGLIGIBLE_DARK, NEGLIGIBLE = 1e-3, 1e-5
LARGEST_THROWN_BACK = 1.0 - 1e-4
ROUNDS = 30  # of the iteration for r, which gains a digit per round or more


@dataclass(frozen=True, eq=False)
class Reflections:
    """`first` (F), `again` (W), and `thrown_back`, r, [side, row, channel, column]."""

    first: Slices
    again: Slices
    thrown_back: np.ndarray


@dataclass(frozen=True, eq=False)
class BaseLight:
    """`dark`, and what a color adds; None if the color is fixed, where `dark` holds all light."""

    dark: Slices
    colored: Reflections | None = None

    def parts(self) -> dict[str, Slices]:
        """The slices of each part, by the role of its strips."""
        if self.colored is None:
            return {DARK: self.dark}
        return {DARK: self.dark, FIRST: self.colored.first, AGAIN: self.colored.again}

    def extremes(self) -> list[Slices]:
        """The light of a white base and, if the color varies, the part that a dark color leaves."""
        if self.colored is None:
            return [self.dark]
        return [_sum([self.dark, self.colored.first, self.colored.again]), self.colored.first]

    def albedos(self) -> BaseLight:
        """The light with its albedos alone."""
        def kept(light: Slices) -> Slices:
            return replace(light, values=np.zeros(0))

        colored = self.colored
        return BaseLight(kept(self.dark), None if colored is None else Reflections(
            kept(colored.first), kept(colored.again), colored.thrown_back))

    @staticmethod
    def joined(lights: Sequence[BaseLight]) -> BaseLight:
        """Lights along the axis of rows."""
        dark, colored = joined([light.dark for light in lights]), [light.colored for light in lights]
        every = [one for one in colored if one is not None]
        if not every:
            return BaseLight(dark)
        return BaseLight(dark, Reflections(joined([one.first for one in every]),
                                           joined([one.again for one in every]),
                                           np.concatenate([one.thrown_back for one in every], axis=1)))


def of_colors(black: Slices, seen: Sequence[Slices], last: np.ndarray) -> BaseLight:
    """The light of a base from slices at the first three COLORS, and the albedo at the last one."""
    none, low, white = seen
    _, small, _, large = COLORS
    change, most = low.whole - none.whole, white.whole - none.whole
    thrown_back = np.full(most.shape, 0.5)
    for _ in range(ROUNDS):
        part = repeated(small, thrown_back)
        first = (change - part * most) / (small - part)
        again = np.maximum(most - first, 0.0)
        left = (last - none.whole - large * first) / large**2
        share = np.clip(np.where(again > 0.0, left / np.where(again > 0.0, again, 1.0), 1.0), 0.0, 1.0)
        thrown_back = np.minimum((1.0 - share) / (1.0 - share * large), LARGEST_THROWN_BACK)
    part = repeated(small, thrown_back)
    first = _kept(_sum([low, none, white, none], [1.0, -1.0, -part, part], small - part), white, NEGLIGIBLE)
    again = _kept(_sum([white, none, first], [1.0, -1.0, -1.0]), white, NEGLIGIBLE)
    return BaseLight(beyond(none, black), Reflections(first, again, thrown_back))


def beyond(one: Slices, other: Slices) -> Slices:
    """The light of `one` beyond that of `other`."""
    return _kept(_sum([one, other], [1.0, -1.0]), one, NEGLIGIBLE_DARK)


def _sum(found: Sequence[Slices], factors: Sequence = (), divisor=1.0) -> Slices:
    """The sum of slices times factors, numbers or [side, row, channel, column], over a divisor."""
    factors = [np.asarray(factor) / divisor for factor in factors or [1.0] * len(found)]

    def total(name: str, more: int = 0) -> np.ndarray:
        whole = np.zeros_like(getattr(found[0], name))
        for one, factor in zip(found, factors, strict=True):
            whole += getattr(one, name) * np.reshape(factor, factor.shape + (1,) * more)
        return whole

    return Slices(total("values", 1), total("albedo"), None, total("direct"))


def _kept(light: Slices, whole: Slices, negligible: float) -> Slices:
    """The light where its albedo is above a share of that of `whole`."""
    albedo, direct = (np.where(part > negligible * whole.whole, part, 0.0) for part in (light.albedo, light.direct))
    return Slices(np.where(albedo[..., None] > 0.0, light.values, 0.0), albedo, None, direct)

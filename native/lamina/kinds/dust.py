# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of settling: how dust falls and how much stays.

To add an option, add a member of Settling and, unless it is a vector, an entry of OPTIONS. The command line and the
add-on's properties and panel are made from the entry."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from dataclasses import dataclass

from .errors import DustError
from .panel import Panel
from .substances import extinction_of

# Attributes of a Blender mesh that hold settled dust; the second is dust on back faces, for two-sided dust.
ATTRIBUTE, BACK_ATTRIBUTE = "lamina_dust", "lamina_dust_back"
MOST_SPREAD = 1.5  # radians: grains that fall level never land
MOST_WIND = 20.0  # relative to the speed of the fall


@dataclass(frozen=True)
class DustOption:
    """A number or switch of Settling; a number lies in [low, high]. `unit`: "rad" or "m". `optional`: may be None,
    shown as 0 in the panel. `whole`: a whole number. `switch`: true or false. `help`: text of the command line, without
    the default; "" for no flag. `group`: the part of the panel, see GROUPS."""

    name: str
    low: float
    high: float
    panel: Panel | None = None
    unit: str = ""
    optional: bool = False
    whole: bool = False
    switch: bool = False
    help: str = ""
    group: str = ""

    def check(self, value) -> None:
        """Raises DustError unless `value` is allowed."""
        if self.switch or value is None and self.optional:
            return
        if self.whole:
            if isinstance(value, bool) or not isinstance(value, int) or not self.low <= value <= self.high:
                span = f"from {self.low} to {self.high}"
                raise DustError(f"settling.{self.name} = {value!r}: must be a whole number {span}")
        elif not _is_number(value) or not self.low <= value <= self.high:
            raise DustError(f"settling.{self.name} = {value!r}: must lie in [{self.low:g}, {self.high:g}]")


# Parts of the panel: (name, heading).
GROUPS = (("amount", "How Much"), ("from", "Where From"), ("stay", "Where It Stays"), ("to", "Where To"))

# In the panel's order. The panel has the defaults of Settling, except where an entry has its own.
OPTIONS = (
    DustOption("amount", 0.0, 1e3, Panel(
        "Amount", "Optical thickness on an open horizontal plate: 0.1 is a veil, 1 is dusty, 10 hides all", 1.0,
        soft_high=10.0, step=10), optional=True, group="amount"),
    DustOption("grams", 0.0, 1e6, Panel(
        "Mass", "Grams on a square metre of an open horizontal plate", 2.0, soft_high=50.0, step=10,
        text="Mass (g/m²)"), optional=True, group="amount"),
    DustOption("time", 0.0, 1e6, Panel(
        "Time", "For how long it falls: so many times the amount", soft_high=10.0, step=10,
        text="Time (x Amount)"), group="amount"),
    DustOption("spread", 0.0, MOST_SPREAD, Panel(
        "Spread", "Half-angle of the cone from which grains fall", high=math.radians(85.0),
        subtype="ANGLE"), unit="rad", help="half-angle of the fall", group="from"),
    DustOption("repose", 0.0, math.pi, Panel(
        "Slope", "Where a surface is steeper, more than half of the grains slide off", subtype="ANGLE"), unit="rad",
        help="angle of repose", group="stay"),
    DustOption("repose_width", 0.0, math.pi, unit="rad"),
    DustOption("concavity", 0.0, 1.0, Panel(
        "Concavity", "How much of what would slide off stays in corners and folds", subtype="FACTOR"), group="stay"),
    DustOption("reach", 1e-12, 1e12, unit="m", optional=True),
    DustOption("coverage", 0.0, 1.0, Panel(
        "Coverage", "Share of the surface that keeps its dust; elsewhere it is wiped off", subtype="FACTOR"),
        help="share of the surface that is left dusty", group="stay"),
    DustOption("patch", 1e-12, 1e12, Panel(
        "Patch Size", "Size of those patches; 0 is a tenth of the object", 0.0, low=0.0, high=1e6, soft_high=1.0,
        subtype="DISTANCE"), unit="m", optional=True, group="stay"),
    DustOption("rubbed", 0.0, 1.0, Panel(
        "Rubbed Edges", "How much is rubbed off at convex edges. Needs a fine mesh, or dust in an image",
        subtype="FACTOR"), help="share of the dust that is rubbed off at convex edges", group="stay"),
    DustOption("edge", 1e-12, 1e12, Panel(
        "Edge Width", "Distance from the edge up to which it is rubbed; 0 is a fiftieth of the object", 0.0, low=0.0,
        high=1e6, soft_high=0.1, subtype="DISTANCE"), unit="m", optional=True,
        help="width of rubbed edges in metres", group="stay"),
    DustOption("two_sided", 0, 1, Panel(
        "Two-Sided", "Dust lies on either side of a face: leaves, cloth. Each side shows its own"), switch=True,
        help="dust lies on either side of faces", group="stay"),
    DustOption("rays", 1, 65536, Panel(
        "Rays", "Rays per point: more are slower and smoother", soft_low=16, soft_high=4096,
        text="Rays per Point"), whole=True,
        help="rays a vertex", group="to"),
)  # fmt: skip


@dataclass(frozen=True)
class Settling:
    """How dust falls and how much stays. Angles in radians, lengths in metres. Raises DustError.

    amount: optical thickness on an open horizontal plate, [0, 1000]; 1 if `grams` is not given.
    grams: areal mass in g/m^2 instead of the amount, [0, 1e6]; times `extinction` it is the optical thickness.
    extinction: of mass, in m^2/g, (0, 1000], or the id of a dust in `lamina.kinds.substances` (green channel).
    time: duration of the fall, in units of the time in which `amount` falls, [0, 1e6].
    gravity: the direction down, of any length but 0.
    spread: half-angle of the cone from which grains fall, evenly over solid angle, [0, MOST_SPREAD].
    wind: velocity of the wind relative to the speed of the fall; its part along gravity is ignored. Wind of length 1
        tilts the fall by 45 degrees. Length at most 20.
    repose: slope at which half of the grains slide off, [0, pi]; pi: all stay wherever they touch.
    repose_width: range of slopes, centred on `repose`, over which grains begin to slide, [0, pi].
    concavity: how much of the sliding dust stays in concavities, [0, 1]: a share concavity * (1 - exposure) stays,
        where exposure is the cosine-weighted part of the hemisphere that is open within `reach`.
    reach: distance up to which neighbours shelter, > 0; None: 5 % of the diagonal of the surface's box.
    coverage: share of the surface, [0, 1], that keeps its dust, in soft-edged patches; elsewhere dust is wiped off.
    patch: size of those patches, > 0; None: 10 % of the diagonal.
    rubbed: how much dust is rubbed off at convex edges, [0, 1]: a share rubbed * convexity, where convexity is 1 at an
        edge of 90 degrees and falls to 0 over the distance `edge`, measured by rays into the body. Flat and concave
        places keep their dust, and so do edges of open sheets.
    edge: width of rubbed edges, > 0; None: 2 % of the diagonal.
    two_sided: dust lies on both sides of a face (leaves, cloth, unreliable normals). The result is the sum of both
        sides, and the back alone. Otherwise dust lies only on the side of the normal. Any face stops grains, from
        either side.
    rays: rays per point, 1 to 65536. With two or more, dust is a ratio of sums over rays, exact where the sky is open.
        On bumpy balls among others, 128 leave a noise of .5 % rms of the amount. On partly hidden slopes the ratio is
        biased: on slopes of 40 to 80 degrees with one half of the sky hidden, by at most .004 of the amount with 2
        rays, .002 with 4, .0004 with 8. A single ray has no bias, but is noisy also on open slopes. From 128 rays on, a
        point traces a quarter of them first; if all of these are open or all are hidden, it traces the rest only once
        in 4 times, with the weight 4, which keeps the mean."""

    amount: float | None = None
    grams: float | None = None
    extinction: float | str = "dust-saharan-1.7um"
    time: float = 1.0
    gravity: Sequence[float] = (0.0, 0.0, -1.0)
    spread: float = math.radians(35.0)
    wind: Sequence[float] = (0.0, 0.0, 0.0)
    repose: float = math.radians(45.0)
    repose_width: float = math.radians(20.0)
    concavity: float = 0.5
    reach: float | None = None
    coverage: float = 1.0
    patch: float | None = None
    rubbed: float = 0.0
    edge: float | None = None
    two_sided: bool = False
    rays: int = 128

    def __post_init__(self):
        if self.amount is not None and self.grams is not None:
            raise DustError("settling has both amount and grams: must have one of them")
        for option in OPTIONS:
            option.check(getattr(self, option.name))
        extinction_of(self.extinction)
        if not math.hypot(*_vector(self.gravity, "settling.gravity")) > 0.0:
            raise DustError(f"settling.gravity = {tuple(self.gravity)!r}: must not be zero")
        if math.hypot(*_vector(self.wind, "settling.wind")) > MOST_WIND:
            raise DustError(f"settling.wind = {tuple(self.wind)!r}: must be at most {MOST_WIND:g} long")

    @property
    def tau(self) -> float:
        """Optical thickness on an open horizontal plate."""
        if self.grams is not None:
            return self.grams * extinction_of(self.extinction) * self.time
        return (1.0 if self.amount is None else self.amount) * self.time


def _is_number(value) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)


def _vector(value, name: str) -> list[float]:
    value_list = value.tolist() if hasattr(value, "tolist") else value
    items = list(value_list) if isinstance(value_list, Sequence) and not isinstance(value_list, str) else []
    if len(items) != 3 or not all(_is_number(item) and abs(item) <= 1e9 for item in items):
        raise DustError(f"{name} = {value!r}: must be three numbers")
    return items

# SPDX-License-Identifier: GPL-3.0-or-later
"""Media that vary with depth: the knots of a profile, and their form for the core."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..common.errors import StackError, quoted
from ..kinds.fields import Channels, Field, all_fields, channel, check_forms, check_keys, to_plain
from ..kinds.hashable import Hashable
from ..kinds.media import BY_ALBEDO, BY_COEFFICIENTS, BY_COLOUR, DEPTH, OVER
from .phase import Phase, check_phase, read_phase

# The largest thickness of a medium with a profile, by the quantity that gives the thickness.
THICKNESS = {
    "tau": Field("tau", 0.0, 1e9, rule="must lie in [0, 1e9] for a medium with a profile"),
    "thickness": Field("thickness", 0.0, 1e12, rule="must lie in [0, 1e12] mm for a medium with a profile"),
}
# Largest errors of the linear interpolation in optical depth for coefficients linear in millimetres: of the albedo, and
# of the share of the phase function at either end.
ALBEDO_ERROR, SHARE_ERROR = 1e-4, 1e-3


@dataclass(frozen=True)
class Knot(Hashable):
    """The medium at one depth, 0 (top) to 1 (bottom). Quantities are numbers or one per channel.

    Either `albedo`, [0, 1], or `color`, [0, 1], the colour of a homogeneous layer of the same thickness, in a medium
    with `tau`: the depth is a share of the optical thickness, and albedo times phase function is linear in it between
    knots. Or `sigma_s` and `sigma_a`, 1/mm, in a medium with `thickness`: the depth is a share of the thickness, and
    sigma_t and sigma_s times phase function are linear in it. `phase`: the medium's phase function if not given. Two
    knots of one depth are a jump."""

    depth: float
    albedo: Channels | None = None
    phase: Phase | None = None
    sigma_s: Channels | None = None
    sigma_a: Channels | None = None
    color: Channels | None = None

    forms = tuple(form.local for form in (BY_ALBEDO, BY_COEFFICIENTS, BY_COLOUR))
    fields = ()

    @property
    def has_coefficients(self) -> bool:
        return self.sigma_s is not None

    def checked(self, path: str) -> Knot:
        """A copy with every quantity as floats. Raises StackError, with the quantity's path."""
        values = check_forms(self, path)
        depth = DEPTH.check(self.depth, f"{path}.depth")
        if isinstance(depth, tuple):
            raise StackError(f"{path}.depth = {quoted(self.depth)}: must be one number")
        phase = None if self.phase is None else check_phase(self.phase, f"{path}.phase")
        return replace(self, depth=depth, phase=phase, **values)

    def quantities(self, path: str):
        """(path, value) of every quantity that may have channels."""
        for quantity in all_fields(self):
            yield f"{path}.{quantity.name}", getattr(self, quantity.name)
        if self.phase is not None:
            yield from self.phase.quantities(f"{path}.phase")

    def to_json(self) -> dict:
        """A JSON object; `read_profile` reads it."""
        values = {quantity.name: getattr(self, quantity.name) for quantity in all_fields(self)}
        entry: dict = {"depth": self.depth}
        entry.update({name: to_plain(value) for name, value in values.items() if value is not None})
        if self.phase is not None:
            entry["phase"] = self.phase.to_json()
        return entry


def read_profile(entries, path: str) -> list[Knot]:
    """The knots from their JSON objects. Raises StackError for missing and unknown keys; values are checked later."""
    if not isinstance(entries, list):
        raise StackError(f"{path} = {quoted(entries)}: must be a list of knots, top first")
    names = {quantity.name for form in Knot.forms for quantity in form}
    knots = []
    for index, entry in enumerate(entries):
        here = f"{path}[{index}]"
        check_keys(entry, {"depth", "phase", *names}, here, required={"depth"})
        values = dict(entry)
        if "phase" in values:
            values["phase"] = read_phase(values["phase"], f"{here}.phase")
        knots.append(Knot(**values))
    return knots


def check_profile(medium, path: str) -> dict:
    """The checked quantities of a Medium with a profile: the profile itself and tau or thickness, and `over`.

    Raises StackError, naming `path`."""
    for name in ("albedo", "color", "sigma_s", "sigma_a"):
        if getattr(medium, name) is not None:
            raise StackError(f"{path}.{name}: must be left out of a medium with a profile, whose knots have it")
    if not isinstance(medium.profile, list | tuple) or len(medium.profile) < 2:
        is_list = isinstance(medium.profile, list | tuple)
        count = f" has {len(medium.profile)}" if is_list else f" = {quoted(medium.profile)}"
        raise StackError(f"{path}.profile{count}: must be a list of two knots or more, top first")
    knots = []
    for index, knot in enumerate(medium.profile):
        if not isinstance(knot, Knot):
            raise StackError(f"{path}.profile[{index}] = {quoted(knot)}: must be a Knot")
        knots.append(knot.checked(f"{path}.profile[{index}]"))
    _check_depths(knots, f"{path}.profile")
    values: dict = {"profile": tuple(knots)}
    wanted, other = ("thickness", "tau") if knots[0].has_coefficients else ("tau", "thickness")
    for index, knot in enumerate(knots):
        if knot.has_coefficients != knots[0].has_coefficients:
            form = "sigma_s, sigma_a" if knots[0].has_coefficients else "albedo or color"
            raise StackError(f"{path}.profile[{index}]: must have {form} like the first knot")
    if getattr(medium, other) is not None:
        raise StackError(f"{path}.{other}: must be left out, the profile's knots go with {wanted}")
    if getattr(medium, wanted) is None:
        raise StackError(f"{path}.{wanted} is missing: must be given with a profile of such knots")
    values[wanted] = THICKNESS[wanted].check(getattr(medium, wanted), f"{path}.{wanted}")
    if medium.over is not None:
        if all(knot.color is None for knot in knots):
            raise StackError(f"{path}.over: must be left out where no knot has a color")
        values["over"] = OVER.check(medium.over, f"{path}.over")
    return values


def _check_depths(knots: list[Knot], path: str) -> None:
    for index, end in ((0, 0.0), (len(knots) - 1, 1.0)):
        if knots[index].depth != end:
            raise StackError(f"{path}[{index}].depth = {knots[index].depth:g}: must be {end:g}")
    depths = [knot.depth for knot in knots]
    for index in range(1, len(depths)):
        if depths[index] < depths[index - 1]:
            raise StackError(f"{path}[{index}].depth = {depths[index]:g}: must be at least {depths[index - 1]:g}, "
                             "that of the knot above")
        # A jump consists of two knots and lies inside the medium.
        if depths[index] == depths[index - 1] and (
                depths[index] in (0.0, 1.0) or (index > 1 and depths[index] == depths[index - 2])):
            raise StackError(f"{path}[{index}].depth = {depths[index]:g}: must be larger than that of the knot above")


def turned(knots: Sequence[Knot]) -> tuple[Knot, ...]:
    """The profile upside down."""
    return tuple(replace(knot, depth=1.0 - knot.depth) for knot in reversed(knots))


def tau_of(medium, index: int) -> float:
    """Tau of a Medium with a profile, in one channel."""
    if medium.tau is not None:
        return channel(medium.tau, index)
    return math.fsum(tau for _, _, tau in _pieces(medium, index))


def optical_knots(medium, albedos, index: int) -> list[tuple[float, float, tuple]]:
    """Knots (optical depth, albedo, phase) of one channel, as the core's GradedMedium takes them; `albedos`: by knot
    and channel, of the knots that are given by a colour.

    For coefficients linear in millimetres, more knots are inserted, so that linear interpolation has errors of at most
    ALBEDO_ERROR in the albedo and SHARE_ERROR in the share of the phase function at either end. With e = sigma_t both
    have the form A + B / e, and knots at equal steps of e^-1/2 distribute the interpolation error evenly."""
    knots = medium.profile
    if not knots[0].has_coefficients:
        tau = channel(medium.tau, index)
        found = []
        for number, knot in enumerate(knots):
            albedo = channel(knot.albedo, index) if knot.albedo is not None else albedos[number][index]
            found.append((knot.depth * tau, albedo, _phase(knot, medium).in_channel(index)))
        return found
    found = []
    depth = 0.0
    for above, below, tau in _pieces(medium, index):
        if tau > 0.0:
            for knot in _chords(above, below, tau, depth):
                if not found or found[-1] != knot:
                    found.append(knot)
            depth += tau
    return found


def _phase(knot: Knot, medium) -> Phase:
    return medium.phase if knot.phase is None else knot.phase


def coefficients_at(knot: Knot, medium, index: int) -> tuple[float, float, tuple]:
    """(sigma_s, sigma_t, phase function as the core takes it) of a knot that has coefficients, in one channel."""
    sigma_s = channel(knot.sigma_s, index)
    return sigma_s, sigma_s + channel(knot.sigma_a, index), _phase(knot, medium).in_channel(index)


def _pieces(medium, index: int):
    """((sigma_s, sigma_t, phase) above, below, tau) between neighbouring knots."""
    thickness = channel(medium.thickness, index)
    ends = [coefficients_at(knot, medium, index) for knot in medium.profile]
    for (upper, lower), (above, below) in zip(
            itertools.pairwise(medium.profile), itertools.pairwise(ends), strict=True):
        yield above, below, 0.5 * (above[1] + below[1]) * (lower.depth - upper.depth) * thickness


def _chords(above: tuple, below: tuple, tau: float, depth: float):
    """Knots of one piece, its ends included."""
    (s0, e0, p0), (s1, e1, p1) = above, below
    if e0 == 0.0 or e1 == 0.0:
        # If one end is clear, albedo and phase function are everywhere those of the other end.
        s, e, p = (s1, e1, p1) if e0 == 0.0 else (s0, e0, p0)
        return [(depth, s / e, p), (depth + tau, s / e, p)]
    u0, u1 = e0**-0.5, e1**-0.5
    errors = abs(s0 / e0 - s1 / e1) / ALBEDO_ERROR
    if p0 != p1:
        errors = max(errors, max(s0 / e0, s1 / e1) / SHARE_ERROR)
    count = max(1, math.ceil(math.sqrt(1.5 * errors * abs(u0 - u1) / (u0 + u1))))
    knots = []
    for k in range(count + 1):
        e = {0: e0, count: e1}.get(k, (u0 + (u1 - u0) * k / count) ** -2)
        way = k / count if e0 == e1 else (e - e0) / (e1 - e0)
        part0, part1 = (1.0 - way) * s0, way * s1
        t = tau if k == count else tau * way * (e0 + e) / (e0 + e1)
        knots.append((depth + t, min(1.0, (part0 + part1) / e), mixed(p0, part0, p1, part1)))
    return knots


def mixed(p0: tuple, part0: float, p1: tuple, part1: float) -> tuple:
    """A mixture of two phase functions, as the core takes it; mixtures do not nest."""
    if p0 == p1 or part1 == 0.0:
        return p0
    if part0 == 0.0:
        return p1
    parts = []
    for phase, part in ((p0, part0), (p1, part1)):
        share = part / (part0 + part1)
        inner = phase[1:] if phase[0] == "mixture" else ((1.0, phase),)
        parts += [(share * own, kind) for own, kind in inner]
    return ("mixture", *parts)

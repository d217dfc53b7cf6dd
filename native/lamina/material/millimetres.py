# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths of a stack's media in millimetres, which are needed for light that travels sideways."""

from __future__ import annotations

import hashlib
import json
import math
from typing import NamedTuple

from ..common.errors import StackError
from ..kinds.bases import HalfSpace
from ..kinds.fields import channel, to_plain
from ..kinds.films import Film
from .layers import Medium
from .stack import Stack


class DepthKnot(NamedTuple):
    """One point of a medium: the optical depth below the medium's top, the depth in mm, and sigma_t in 1/mm."""

    tau: float
    depth: float
    sigma_t: float


def require_millimetres(stack: Stack) -> None:
    """Raises StackError unless all media of the stack are given by sigma_s and sigma_a in 1/mm and a thickness in mm,
    and media that neither scatter nor absorb have a finite thickness; and for a base that such light does not take."""
    stack.require_walked_base()
    for index, layer in enumerate(stack.layers):
        path = f"layers[{index}]"
        if isinstance(layer, Film):
            raise StackError(f"{path}.kind = 'film': must be left out where light moves sideways")
        if not isinstance(layer, Medium):
            continue
        if layer.thickness is None:
            given = "albedo" if layer.color is None else "color"
            given = given if layer.profile is None else "a profile of albedos"
            raise StackError(f"{path}: has no lengths, must have sigma_s and sigma_a (1/mm) and thickness (mm) instead "
                             f"of {given} and tau where light moves sideways")
        if layer.profile is None:
            for c in range(stack.channels):
                if sigma_t(layer, c) == 0.0 and math.isinf(channel(layer.thickness, c)):
                    raise StackError(f"{path}.thickness = inf: an infinitely thick medium must scatter or absorb")
    if isinstance(stack.base, HalfSpace):
        if stack.base.sigma_s is None:
            raise StackError("base: has no lengths, must have sigma_s and sigma_a (1/mm) instead of albedo where light "
                             "moves sideways")
        if any(sigma_t(stack.base, c) == 0.0 for c in range(stack.channels)):
            raise StackError("base.sigma_s = 0: an infinitely thick medium must scatter or absorb")


def has_lengths(stack: Stack) -> bool:
    """True if the stack holds a medium or a half-space, and all of them are given in millimetres, so that
    lamina.searchlight can compute how far light travels sideways."""
    if not any(isinstance(part, Medium | HalfSpace) for part in (*stack.layers, stack.base)):
        return False
    try:
        require_millimetres(stack)
    except StackError:
        return False
    return True


def depth_knots(stack: Stack, index: int) -> list[tuple[DepthKnot, ...]]:
    """The relation of optical depth to millimetres in one channel: the knots of every layer, top first, and of a
    half-space as the base; no knots for an interface.

    Between two knots sigma_t is linear in the depth, so sigma_t^2 is linear in the optical depth. Two knots at one
    depth are a jump; two knots at one optical depth bound a clear part. An infinitely thick medium has its last knot at
    infinity. Raises StackError as require_millimetres does."""
    require_millimetres(stack)
    found: list[tuple[DepthKnot, ...]] = []
    for layer in stack.layers:
        if not isinstance(layer, Medium):
            found.append(())
        elif layer.profile is not None:
            found.append(_profile_knots(layer, index))
        else:
            found.append(_homogeneous(sigma_t(layer, index), channel(layer.thickness, index)))
    if isinstance(stack.base, HalfSpace):
        found.append(_homogeneous(sigma_t(stack.base, index), math.inf))
    return found


def lengths_hash(stack: Stack) -> str:
    """Identifies the stack with its lengths: SHA-256 of the stack's hash and of all depth knots, hexadecimal. Stacks
    with equal hashes may differ in their lengths. Raises StackError as require_millimetres does."""
    lengths = [[[[to_plain(number) for number in knot] for knot in knots] for knots in depth_knots(stack, c)]
               for c in range(stack.channels)]
    return hashlib.sha256(json.dumps([stack.hash, lengths]).encode()).hexdigest()


def sigma_t(medium, index: int) -> float:
    """Extinction in 1/mm of a medium, a half-space or a knot that has coefficients, in one channel."""
    return channel(medium.sigma_s, index) + channel(medium.sigma_a, index)


def _homogeneous(extinction: float, thickness: float) -> tuple[DepthKnot, ...]:
    tau = extinction * thickness if extinction > 0.0 else 0.0
    return DepthKnot(0.0, 0.0, extinction), DepthKnot(tau, thickness, extinction)


def _profile_knots(layer: Medium, index: int) -> tuple[DepthKnot, ...]:
    thickness = channel(layer.thickness, index)
    found: list[DepthKnot] = []
    tau = 0.0
    for knot in layer.profile or ():
        here = DepthKnot(tau, knot.depth * thickness, sigma_t(knot, index))
        if found:
            above = found[-1]
            tau += 0.5 * (above.sigma_t + here.sigma_t) * (here.depth - above.depth)
            here = here._replace(tau=tau)
        found.append(here)
    return tuple(found)

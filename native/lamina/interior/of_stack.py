# SPDX-License-Identifier: GPL-3.0-or-later
"""The homogeneous interior that a stack with one medium stands for."""

from __future__ import annotations

import numpy as np

from ..common.errors import StackError
from ..kinds.bases import HalfSpace
from ..kinds.boundaries import Interface
from ..kinds.fields import channel
from ..kinds.phases import HenyeyGreenstein, Isotropic
from ..material.any_stack import AnyStack, as_stack
from ..material.layers import Medium
from ..material.millimetres import require_millimetres
from ..material.stack import Stack
from ..subsurface.depth_colours import in_colours
from .end_material import CHANNELS, EndMaterial
from .grid import Interior
from .problem import Surface


def interior_of_stack(stack: AnyStack) -> tuple[Interior, Surface]:
    """(interior, surface) of a body that a stack fills: an optional interface on top, and one medium in 1/mm below, as
    a layer or as a half-space; the thickness of a layer is not used. A medium of infinite thickness hides the rest. The
    phase function is isotropic or Henyey-Greenstein. If g differs between channels, all get the mean g, and sigma_s is
    scaled so that sigma_s (1 - g) stays the same (similarity). Wavelengths become red, green and blue: media with the
    color and the mean exit distances of the spectrum in a thick body. Raises StackError for other stacks,
    InteriorError for coefficients out of range."""
    stack = as_stack(stack)
    stack.require_isotropic("light inside a body")
    stack.require_no_flakes("light inside a body")
    require_millimetres(stack)
    stack = in_colours(stack)
    top = stack.layers[0] if stack.layers and isinstance(stack.layers[0], Interface) else None
    media = [part for part in (*stack.layers[0 if top is None else 1:], stack.base) if part is not None]
    if media and isinstance(media[0], Medium) and np.all(np.asarray(media[0].thickness, float) == np.inf):
        media = media[:1]  # hides what lies below
    if len(media) != 1 or not isinstance(media[0], Medium | HalfSpace) or getattr(media[0], "profile", None):
        raise StackError("layers: must be one homogeneous medium, below at most one interface, to fill a body")
    medium = media[0]
    if not isinstance(medium.phase, Isotropic | HenyeyGreenstein):
        raise StackError("phase: must be isotropic or Henyey-Greenstein inside a body")
    sigma_s, sigma_a, by_channel = ([channel(values, c % stack.channels) for c in range(CHANNELS)] for values in
                                    (medium.sigma_s, medium.sigma_a, getattr(medium.phase, "g", 0.0)))
    g = sum(by_channel) / CHANNELS
    sigma_s = [s * (1.0 - own) / (1.0 - g) for s, own in zip(sigma_s, by_channel, strict=True)]
    interior = Interior.uniform(EndMaterial(sigma_s, sigma_a, g))
    if top is None:
        return interior, Surface()
    return interior, Surface(_mean(top.ior, stack), _mean(top.alpha, stack), top.distribution)


def _mean(values, stack: Stack) -> float:
    found = [channel(values, c) for c in range(stack.channels)]
    return found[0] if len(set(found)) == 1 else sum(found) / len(found)  # without rounding where all are equal

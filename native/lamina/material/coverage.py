# SPDX-License-Identifier: GPL-3.0-or-later
"""The film that a varying interface begins: water between drops and dry spots, a puddle, varnish that wears off.

A film is the interface and the media below it, down to the next interface or the base."""

from __future__ import annotations

from collections.abc import Sequence

from ..kinds.boundaries import Interface
from ..kinds.fields import Channels, channel
from ..kinds.films import Film
from .layers import Medium
from .stack_checks import Layer

NOTHING = Medium(albedo=0.0, tau=0.0)


def without_film(layers: Sequence[Layer], first: int, channels: int) -> list[Layer]:
    """What is left of checked layers of so many channels without the film of the interface with index `first`.

    Indices of interfaces are absolute, so what lies below then meets the index above the film. An interface that would
    lie between two equal indices goes too, as the lower face of a film in air. So do thin films on the interface; those
    on a lower interface, or on a metal, stay with it."""
    above: Channels = 1.0
    for layer in layers[:first]:
        above = layer.ior if isinstance(layer, Interface) else above
    begin = first_film(layers, first)
    below = next((k for k in range(first + 1, len(layers)) if isinstance(layers[k], Interface)), len(layers))
    below = first_film(layers, below)
    rest = list(layers[below:])
    lower = rest[0] if rest else None
    if isinstance(lower, Interface) and all(channel(lower.ior, c) == channel(above, c) for c in range(channels)):
        rest = rest[1:]
    return [*layers[:begin], *rest]


def first_film(layers: Sequence[Layer], surface: int) -> int:
    """The index of the first thin film on a surface; of the surface itself if it has none."""
    while surface > 0 and isinstance(layers[surface - 1], Film):
        surface -= 1
    return surface

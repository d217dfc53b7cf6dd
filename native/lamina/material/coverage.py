# SPDX-License-Identifier: GPL-3.0-or-later
"""The film that a varying interface begins: water between drops and dry spots, a puddle, varnish that wears off.

A film is the interface and the media below it, down to the next interface or the base."""

from __future__ import annotations

from collections.abc import Sequence

from ..kinds.boundaries import Interface
from ..kinds.fields import Channels, channel
from .layers import Medium

NOTHING = Medium(albedo=0.0, tau=0.0)


def without_film(layers: Sequence[Medium | Interface], first: int, channels: int) -> list[Medium | Interface]:
    """What is left of checked layers of so many channels without the film of the interface with index `first`.

    Indices of interfaces are absolute, so what lies below then meets the index above the film. An interface that would
    lie between two equal indices goes too, as the lower face of a film in air."""
    above: Channels = 1.0
    for layer in layers[:first]:
        above = layer.ior if isinstance(layer, Interface) else above
    below = next((k for k in range(first + 1, len(layers)) if isinstance(layers[k], Interface)), len(layers))
    rest = list(layers[below:])
    lower = rest[0] if rest else None
    if isinstance(lower, Interface) and all(channel(lower.ior, c) == channel(above, c) for c in range(channels)):
        rest = rest[1:]
    return [*layers[:first], *rest]

# SPDX-License-Identifier: GPL-3.0-or-later
"""What users of a stack cannot take, each refused in one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..common.errors import StackError
from ..kinds.bases import Base, Conductor, PrincipledBase
from ..kinds.boundaries import Interface, is_oriented
from ..kinds.fields import channel, to_plain
from ..kinds.layers import OrientedLayer
from .stack_checks import Layer


class Requirements:
    """The requirements of a Stack's users."""

    layers: Sequence[Layer]
    base: Base | None
    wavelengths: Sequence[float] | None

    if TYPE_CHECKING:
        @property
        def channels(self) -> int: ...

    def require_air_below(self) -> None:
        """Raises StackError for a sheet that does not end in air. Directions below a sheet are given in air, where
        light beyond the critical angle has no direction."""
        indices = [layer.ior for layer in self.layers if isinstance(layer, Interface)]
        if self.base is None and indices and any(channel(indices[-1], c) != 1.0 for c in range(self.channels)):
            raise StackError(f"layers end at index {to_plain(indices[-1])}: a sheet that is baked, or whose directions "
                             "below are asked for, must end with an Interface of ior 1")

    def require_walked_base(self) -> None:
        """Raises StackError for a base that random walks and searchlights do not take."""
        if isinstance(self.base, PrincipledBase):
            raise StackError("base.kind = 'principled': must be 'lambert', 'black', 'half-space', 'conductor', "
                             "'retroreflector' or 'measured' for random walks and searchlights")

    def require_isotropic(self, user: str) -> None:
        """Raises StackError for anisotropic facets, which `user` does not take."""
        for surface, path in ((self.base, "base"), *((layer, f"layers[{i}]") for i, layer in enumerate(self.layers))):
            if isinstance(surface, Interface | Conductor) and is_oriented(surface):
                raise StackError(f"{path}.alpha_v = {surface.alpha_v:g}: must be left out for {user}; only "
                                 "lamina.solve, lamina.estimate and lamina.bake take anisotropic facets")

    def require_colours(self, user: str) -> None:
        """Raises StackError for a stack with wavelengths, where `user` takes red, green and blue."""
        if self.wavelengths is not None:
            raise StackError(f"wavelengths: must be left out for {user}, which takes red, green and blue; pigments, "
                             "metals by their name, and spectra have wavelengths")

    def require_no_flakes(self, user: str) -> None:
        """Raises StackError for a layer of flakes or fibers, which `user` does not take."""
        for number, layer in enumerate(self.layers):
            if isinstance(layer, OrientedLayer):
                raise StackError(f"layers[{number}].kind = '{layer.kind}': must be left out for {user}; lamina.solve, "
                                 f"lamina.estimate by method 'transfer' and lamina.bake take {layer.kind}")

    def require_on_top(self, layer: int, needed: str) -> None:
        """Raises StackError unless this layer is a homogeneous medium on top of the stack."""
        if layer > 0:
            raise StackError(f"layers[{layer}]: must be the top layer {needed}")
        if getattr(self.layers[layer], "profile", None) is not None:
            raise StackError(f"layers[{layer}].profile: must be left out {needed}")

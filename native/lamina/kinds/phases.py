# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions that are described by numbers. The core evaluates them.

To add one, write its class here, with its name in __all__, KINDS and IN_PANEL, and its C++ type in the core. For tables
and mixtures of phase functions see lamina.material.phase."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .fields import Channels, Field, channel, check_keys, to_plain
from .hashable import Hashable
from .panel import Item, Panel

__all__ = ["CornetteShanks", "DoubleHenyeyGreenstein", "Draine", "HenyeyGreenstein", "Isotropic", "Rayleigh"]

# The sharpest forward or backward peak that the solver resolves: moment 320 of Henyey and Greenstein's function, g^320,
# must be below 1e-5. Random walks could follow sharper peaks, but the same stack serves all of Lamina. End materials of
# an interior, which only walks read, have a wider range (see kinds.interiors).
LARGEST_G = 0.964


def _anisotropy(name: str, label: str, default: float, tip: str) -> Field:
    panel = Panel(label, tip, default, step=1, precision=3, words=label.lower())
    return Field(name, -LARGEST_G, LARGEST_G, panel=panel)


G = _anisotropy("g", "Anisotropy", 0.6, "Forward (above 0) or backward (below 0) scattering; for Henyey-Greenstein "
                "the mean cosine")


class PhaseFunction(Hashable):
    """The interface of all phase functions, implemented for those that the numbers `fields` describe.

    `item`: the kind's entry in the panel's list; None for a kind that the panel does not edit."""

    kind = ""
    fields: tuple[Field, ...] = ()
    item: Item | None = None

    def checked(self, path: str):
        """A copy with every quantity as floats. Raises StackError, with the quantity's path."""
        return replace(self, **{  # type: ignore[type-var]  # each kind is a dataclass
            q.name: q.check(getattr(self, q.name), f"{path}.{q.name}") for q in self.fields})

    def quantities(self, path: str):
        """(path, value) of every quantity that may have channels."""
        for quantity in self.fields:
            yield f"{path}.{quantity.name}", getattr(self, quantity.name)

    def in_channel(self, index: int) -> tuple:
        """(kind, parameters...) of one channel, as the core takes them."""
        return (self.kind, *(channel(getattr(self, q.name), index) for q in self.fields))

    def to_json(self) -> dict:
        """A JSON object; read_phase reads it."""
        return {"kind": self.kind, **{q.name: to_plain(getattr(self, q.name)) for q in self.fields}}

    def canonical(self, channels: int) -> dict:
        """The same JSON object, with every quantity repeated for each channel."""
        spread = {q.name: [channel(getattr(self, q.name), c) for c in range(channels)] for q in self.fields}
        return {"kind": self.kind, **spread}

    @classmethod
    def read(cls, entry, path: str):
        """From a JSON object. Raises StackError for missing and unknown keys; values are checked later."""
        names = {q.name for q in cls.fields}
        check_keys(entry, {"kind", *names}, path, required=names)
        return cls(**{name: entry[name] for name in names})


@dataclass(frozen=True)
class Isotropic(PhaseFunction):
    """Equal scattering into all directions."""

    kind = "isotropic"
    item = Item(kind, "Isotropic", "Equal scattering in all directions", 0)


@dataclass(frozen=True)
class HenyeyGreenstein(PhaseFunction):
    """Henyey and Greenstein (1941). `g`, the mean cosine, in [-.964, .964], a number or one per channel."""

    g: Channels

    kind = "hg"
    fields = (G,)
    item = Item(kind, "Henyey-Greenstein", "Forward or backward scattering, set by the anisotropy", 1)


@dataclass(frozen=True)
class DoubleHenyeyGreenstein(PhaseFunction):
    """Two Henyey-Greenstein lobes, weight HG(g1) + (1 - weight) HG(g2) (Irvine 1965), usually one forward and a weak
    backward one. `g1`, `g2` in [-.964, .964], `weight` in [0, 1]; numbers or one per channel."""

    g1: Channels
    g2: Channels
    weight: Channels

    kind = "double-hg"
    fields = (
        _anisotropy("g1", "First Anisotropy", 0.8, "Anisotropy of the first lobe"),
        _anisotropy("g2", "Second Anisotropy", -0.3, "Anisotropy of the second lobe"),
        Field("weight", 0.0, 1.0, panel=Panel("Weight", "Share of the first lobe", 0.9, step=1, precision=3)),
    )
    item = Item(kind, "Double Henyey-Greenstein", "Two lobes: most often one forward and a weak one back", 3,
                words="double Henyey-Greenstein")


@dataclass(frozen=True)
class Rayleigh(PhaseFunction):
    """Scattering by particles much smaller than the wavelength, unpolarised: 3/4 (1 + cos^2)."""

    kind = "rayleigh"
    item = Item(kind, "Rayleigh", "Particles much smaller than the wavelength: haze, smoke", 2)


@dataclass(frozen=True)
class CornetteShanks(PhaseFunction):
    """Cornette and Shanks (1992): Rayleigh scattering at g = 0, a forward lobe for larger g. `g` in [-.964, .964], a
    number or one per channel; the mean cosine is 3 g (4 + g^2) / (5 (2 + g^2))."""

    g: Channels

    kind = "cornette-shanks"
    fields = (G,)
    item = Item(kind, "Cornette-Shanks", "From Rayleigh scattering at 0 into a forward lobe", 5)


@dataclass(frozen=True)
class Draine(PhaseFunction):
    """Draine (2003): Henyey-Greenstein times 1 + alpha cos^2, normalised. `g` in [-.964, .964], `alpha` in [0, 1000];
    numbers or one per channel. alpha 0 is Henyey-Greenstein, alpha 1 Cornette-Shanks. A Mixture of this and
    Henyey-Greenstein fits droplets of fog and cloud well (Jendersie and d'Eon 2023)."""

    g: Channels
    alpha: Channels

    kind = "draine"
    fields = (G, Field("alpha", 0.0, 1000.0, panel=Panel(
        "Draine Alpha", "0 is Henyey-Greenstein, 1 is Cornette-Shanks", 1.0, soft_high=10.0, step=10, precision=3,
        slider=False, prop="draine_alpha")))
    item = Item(kind, "Draine", "Henyey-Greenstein with more light forward and back: dust, droplets", 4)


KINDS = (Isotropic, HenyeyGreenstein, Rayleigh, DoubleHenyeyGreenstein, Draine, CornetteShanks)
IN_PANEL = (Isotropic, HenyeyGreenstein, DoubleHenyeyGreenstein, Rayleigh, CornetteShanks, Draine)  # in this order
USUAL = HenyeyGreenstein  # the default of a new medium in the panel

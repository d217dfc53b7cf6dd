# SPDX-License-Identifier: GPL-3.0-or-later
"""The walks that the study compares, each with one name, and the slabs."""

import time
from dataclasses import dataclass

from lamina import _core

# The reference of every efficiency: next-event estimation at collisions, as in textbooks.
BASELINE = "transfer, plain"
UNTABLED = "scattering, no tables"
ISOTROPIC = "scattering, guided"
GUIDED = "transfer, guided"
METHODS = {
    BASELINE: "photon walk of the equation of transfer, next events at collisions",
    "transfer": "the same with the library's best next events (kFitting)",
    GUIDED: "transfer walk guided by the internal field of a coarse solution",
    UNTABLED: "scattering equation, guided by closed forms alone",
    ISOTROPIC: "scattering equation of isotropic media, guided by a coarse solution",
}


def chosen(g: float) -> str:
    """The walk of `lamina.estimate(method="scattering")`."""
    return GUIDED if g else ISOTROPIC


@dataclass(frozen=True)
class Slab:
    """A homogeneous slab of Henyey-Greenstein scatterers; g = 0 is isotropic."""

    albedo: float
    tau: float
    g: float

    def phase(self) -> tuple:
        return ("hg", self.g) if self.g else ("isotropic",)

    def stack(self, parts: int = 1):
        """The core's stack, in `parts` equal layers."""
        layers = [_core.Medium(self.albedo, self.tau / parts, *self.phase()) for _ in range(parts)]
        return _core.Stack(layers, _core.Base.none())

    def medium(self):
        return _core.GradedMedium.homogeneous(self.albedo, self.tau, *self.phase())


@dataclass(frozen=True)
class Made:
    """A walk ready to run, and the CPU seconds of its set-up."""

    walk: object
    setup: float


def make(method: str, slab: Slab, directions: tuple[float, float, float]) -> Made | None:
    """The walk of a method for directions (mu_o, mu_i, dphi); None if it does not apply to the slab."""
    if method == ISOTROPIC and slab.g:
        return None
    started = time.process_time()
    if method in (BASELINE, "transfer"):
        way = _core.NextEvent.at_collision if method == BASELINE else _core.NextEvent.fitting
        walk = _core.transfer_walk(slab.stack(), _core.WalkTarget(*directions), way)
    elif method == GUIDED:
        walk = _core.guided_transfer_walk(slab.medium(), *directions)
    elif method == ISOTROPIC:
        walk = _core.isotropic_walk(slab.medium(), *directions[:2])
    else:
        walk = _core.slab_scattering_walk(slab.medium(), *directions)
    return Made(walk, time.process_time() - started)

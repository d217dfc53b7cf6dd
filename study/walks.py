# SPDX-License-Identifier: GPL-3.0-or-later
"""The walks that the study compares, each with one name, and the slabs."""

import time
from dataclasses import dataclass

from lamina import _core

# The reference of every efficiency: next-event estimation at collisions, as in textbooks.
BASELINE = "transfer, plain"
OURS = "scattering"
FORCED = "scattering, guided"
METHODS = {
    BASELINE: "photon walk of the equation of transfer, next events at collisions",
    "transfer": "the same with the library's best next events (kFitting)",
    "transfer, guided": "transfer walk guided by the internal field of the same coarse solution",
    "scattering, plain": "scattering equation as it stands, unguided",
    OURS: "scattering equation, by the walk that the pilot chooses, guided or not",
    FORCED: "guided scattering walk where the pilot fell back to another",
}


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
    """A walk ready to run: its name, the CPU seconds of its set-up, and the samples of its pilot."""

    walk: object
    name: str
    setup: float
    pilot_samples: int = 0
    pilot_events: int = 0


def make(method: str, slab: Slab, directions: tuple[float, float, float], seed: int) -> Made | None:
    """The walk of a method for directions (mu_o, mu_i, dphi); None if the core has none."""
    started = time.process_time()
    if method in (BASELINE, "transfer"):
        way = _core.NextEvent.at_collision if method == BASELINE else _core.NextEvent.fitting
        walk = _core.transfer_walk(slab.stack(), _core.WalkTarget(*directions), way)
        return Made(walk, method, time.process_time() - started)
    if method == "transfer, guided":
        if not hasattr(_core, "guided_transfer_walk"):
            return None
        walk = _core.guided_transfer_walk(slab.medium(), *directions)
        return Made(walk, method, time.process_time() - started)
    name = {OURS: "auto", "scattering, plain": "plain", FORCED: forced(slab)}[method]
    started = time.process_time()
    made = _core.ScatteringWalk(slab.medium(), *directions, name, seed)
    return Made(made.walk, made.name, time.process_time() - started, made.pilot_samples, made.pilot_events)


def forced(slab: Slab) -> str:
    """The guided walk that is measured where the pilot falls back: the best one that the core has."""
    if not slab.g:
        return "isotropic"
    try:
        _core.ScatteringWalk(Slab(0.5, 0.1, 0.0).medium(), 1.0, 1.0, 0.0, "residual-16", 0)
    except ValueError:
        return "guided-16"
    return "residual-16"


def fell_back(name: str) -> bool:
    """True if the pilot's choice is not a walk of the scattering equation."""
    return name == "photon" or name.startswith("transfer")

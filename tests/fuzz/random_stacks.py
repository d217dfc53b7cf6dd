# SPDX-License-Identifier: GPL-3.0-or-later
"""Random stacks with all features that a stack's JSON allows. A stack depends only on its seed and number."""

from __future__ import annotations

import math
import random

from drawn_kinds import drawn, of_all

from lamina import (
    Black,
    Conductor,
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Fibers,
    Film,
    Flakes,
    HalfSpace,
    HenyeyGreenstein,
    Interface,
    Isotropic,
    Knot,
    Lambert,
    Medium,
    Mixture,
    Rayleigh,
    Stack,
    Tabulated,
)
from lamina.kinds import bases, phases
from lamina.material.metals import grazing_range

SHARPEST = 0.93  # of |g|; beyond |g| = .964 the solver refuses, which is tested elsewhere
MOST_LAYERS = 6
SPECIAL_BASES = {Black, Conductor, HalfSpace, Lambert}  # drawn with all that they allow, see _Maker.base


def random_stack(seed: int, number: int) -> Stack:
    """Stack `number` of the random sequence with this seed."""
    stack = _Maker(random.Random(f"{seed}:{number}"), random.Random(f"base {seed}:{number}")).stack()
    return with_flakes(stack, random.Random(f"flakes {seed}:{number}"))


def with_flakes(stack: Stack, chance: random.Random) -> Stack:
    """A tenth of the stacks, with a layer of flakes in place of a layer, or of fibers."""
    media = [k for k, layer in enumerate(stack.layers) if isinstance(layer, Medium)]
    if not media or chance.random() > 0.1:
        return stack
    flakes = drawn(Flakes, chance)
    if chance.random() < 0.3:
        facing = chance.uniform(0.3, 0.95)
        grazing = possible_grazing(facing, chance.uniform(0.5 + 0.5 * facing, 1.0))
        flakes = Flakes(flakes.tau, flakes.alpha, facing=facing, grazing=grazing)
    layers = list(stack.layers)
    place = chance.choice(media)
    layers[place] = drawn(Fibers, chance) if chance.random() < 0.3 else flakes
    return Stack(layers, stack.base)


def possible_grazing(facing: float, grazing: float) -> float:
    """The nearest grazing colour that a metal of this facing colour can have. A possible colour stays as it is."""
    low, high = grazing_range(facing)
    return min(max(grazing, low), high)


class _Maker:
    def __init__(self, chance: random.Random, own: random.Random):
        self.chance = chance
        self.own = own  # for bases that are drawn from their descriptions, so that all other stacks stay the same
        self.channels = 3 if chance.random() < 0.25 else 1

    def stack(self) -> Stack:
        base = self.base()
        if base is not None and self.own.random() < 0.1:
            base = drawn(self.own.choice([cls for cls in bases.KINDS if cls not in SPECIAL_BASES]), self.own)
        count = self.chance.choices(range(MOST_LAYERS + 1), (1, 6, 8, 8, 5, 2, 1))[0]
        if base is None and count == 0:
            count = 1
        layers = [self.interface() if self.chance.random() < 0.4 else self.medium() for _ in range(count)]
        indices = [layer.ior for layer in layers if isinstance(layer, Interface)]
        # A sheet is baked with air on both sides.
        if base is None and indices and indices[-1] != 1.0 and self.chance.random() < 0.95:
            layers.append(self.interface(ior=1.0))
        return Stack(self.filmed(layers, base), base)

    def filmed(self, layers: list, base) -> list:
        """The layers, a tenth of them with thin films on one smooth or rough surface."""
        places = [k for k, layer in enumerate([*layers, base]) if isinstance(layer, Interface | Conductor)]
        above = [1.0, *(layer.ior for layer in layers if isinstance(layer, Interface))]
        interfaces = [k for k, layer in enumerate(layers) if isinstance(layer, Interface)]
        places = [k for k in places if k == len(layers) or layers[k].alpha == 0.0
                  or layers[k].ior != above[interfaces.index(k)]]
        if not places or self.own.random() > 0.1:
            return layers
        films = [Film(self.own.uniform(1.2, 2.8), 10.0 ** self.own.uniform(0.0, 3.5), self.own.choice([0.0, 0.0, 0.5]))
                 for _ in range(self.own.choice([1, 1, 2]))]
        place = self.own.choice(places)
        return [*layers[:place], *films, *layers[place:]]

    def log(self, low: float, high: float) -> float:
        return math.exp(self.chance.uniform(math.log(low), math.log(high)))

    def spread(self, draw):
        """One number for all channels, or a number for each."""
        if self.channels == 3 and self.chance.random() < 0.6:
            return [draw() for _ in range(3)]
        return draw()

    def albedo(self) -> float:
        kind = self.chance.random()
        if kind < 0.1:
            return 0.0
        if kind < 0.2:
            return 1.0
        if kind < 0.4:
            return 1.0 - self.log(1e-8, 0.1)
        return self.chance.random()

    def tau(self) -> float:
        kind = self.chance.random()
        if kind < 0.03:
            return 0.0
        if kind < 0.08:
            return math.inf
        if kind < 0.45:
            return self.log(1e-9, 1e-2)
        return self.log(1e-2, 30.0)

    def g(self) -> float:
        return self.chance.choice([self.chance.uniform(-0.6, 0.8), self.chance.uniform(-SHARPEST, SHARPEST)])

    def phase(self, parts: bool = True):
        special = {
            Isotropic: Isotropic,
            Rayleigh: Rayleigh,
            HenyeyGreenstein: lambda: HenyeyGreenstein(self.spread(self.g)),
            DoubleHenyeyGreenstein: lambda: DoubleHenyeyGreenstein(self.spread(self.g), self.spread(self.g),
                                                                   self.chance.random()),
            Draine: lambda: Draine(self.chance.uniform(-0.85, 0.85), self.log(0.01, 1000.0)),
            CornetteShanks: lambda: CornetteShanks(self.spread(lambda: self.chance.uniform(-0.85, 0.85))),
        }
        kinds = [*of_all(phases.KINDS, special, self.chance), self.moments, self.samples]
        if parts:
            kinds.append(self.mixture)
        return self.chance.choice(kinds)()

    def moments(self) -> Tabulated:
        g = self.chance.uniform(-0.6, 0.8)
        count = self.chance.randint(1, 60)
        # Cesaro means of a positive function are positive.
        return Tabulated(moments=[g**order * (1.0 - order / count) ** 2 for order in range(count)]
                         if abs(g) < 0.3 else [g**order for order in range(90)])

    def samples(self) -> Tabulated:
        """A lobe tabulated in steps of about one degree, possibly with noise."""
        count = self.chance.choice([19, 37, 91, 181, 361])
        g, noise = self.chance.uniform(-0.7, 0.8), self.chance.choice([0.0, 0.01, 0.1, 0.3])
        cosines = [math.cos(math.pi * k / (count - 1)) for k in range(count)]
        values = [(1.0 + g * g - 2.0 * g * x) ** -1.5 * math.exp(noise * self.chance.gauss(0.0, 1.0)) for x in cosines]
        return Tabulated(cosines=cosines, values=values)

    def mixture(self) -> Mixture:
        share = self.chance.random()
        return Mixture([(share, self.phase(parts=False)), (1.0 - share, self.phase(parts=False))])

    def medium(self) -> Medium:
        if self.chance.random() < 0.12:
            return self.graded()
        kind = self.chance.random()
        if kind < 0.7:
            return Medium(albedo=self.spread(self.albedo), tau=self.spread(self.tau), phase=self.phase())
        if kind < 0.88:
            return Medium(sigma_s=self.spread(lambda: self.log(1e-3, 1e2)), phase=self.phase(),
                          sigma_a=self.spread(lambda: self.chance.choice([0.0, self.log(1e-4, 1e2)])),
                          thickness=self.log(1e-6, 10.0))
        over = self.chance.choice([None, self.chance.random()])
        tau = self.log(0.01, 30.0)
        color = self.chance.uniform(0.02, 0.9)
        if over is None:
            return Medium(color=color, tau=tau, phase=HenyeyGreenstein(self.chance.uniform(-0.5, 0.85)))
        # Close to the colour below, so that an albedo for the colour exists.
        return Medium(color=over * math.exp(-0.1 * tau), over=over, tau=tau)

    def graded(self) -> Medium:
        inner = sorted(self.chance.random() for _ in range(self.chance.choice([0, 0, 1, 2, 3])))
        if inner and self.chance.random() < 0.3:
            inner.insert(0, inner[0])  # a jump
        depths = [0.0, *inner, 1.0]
        if self.chance.random() < 0.3:
            knots = [Knot(depth, sigma_s=self.log(1e-3, 10.0), sigma_a=self.log(1e-4, 1.0), phase=self.phase())
                     for depth in depths]
            return Medium(thickness=self.log(1e-3, 3.0), profile=knots)
        knots = [Knot(depth, albedo=self.spread(self.albedo), phase=self.phase()) for depth in depths]
        return Medium(tau=self.log(1e-4, 20.0), profile=knots)

    def facets(self) -> dict:
        rough = self.chance.random() < 0.5
        return {"alpha": self.log(1e-3, 1.0) if rough else 0.0,
                "distribution": self.chance.choice(["ggx", "ggx", "beckmann"]),
                "compensate": self.chance.random() < 0.8, "correlated": self.chance.random() < 0.8}

    def interface(self, ior: float | None = None) -> Interface:
        if ior is None:
            ior = self.chance.choice([1.0, 1.0 + self.log(1e-3, 0.3), self.chance.uniform(1.2, 1.8),
                                      self.chance.uniform(1.2, 1.8), self.chance.uniform(1.0, 4.0)])
        return Interface(ior, **self.facets())

    def base(self):
        kind = self.chance.choice(["sheet", "sheet", "black", "lambert", "lambert", "half-space", "metal", "metal"])
        if kind == "black":
            return Black()
        if kind == "lambert":
            return Lambert(self.spread(lambda: self.chance.choice([0.0, 1.0, *([self.chance.random()] * 4)])),
                           textured=self.chance.random() < 0.2)
        if kind == "half-space":
            return HalfSpace(self.spread(self.albedo), self.phase())
        if kind == "metal" and self.chance.random() < 0.3:
            facing = self.chance.uniform(0.3, 0.95)
            grazing = possible_grazing(facing, self.chance.uniform(facing, 1.0))
            return Conductor(facing=facing, grazing=grazing, **self.facets())
        if kind == "metal":
            return Conductor(self.spread(lambda: self.log(0.05, 4.0)), self.spread(lambda: self.log(0.5, 9.0)),
                             **self.facets())
        return None

# SPDX-License-Identifier: GPL-3.0-or-later
"""A Principled base below an interface: the factors of the strips of its closures, from the inputs of the
base. See lamina.baking.bases.covered for the formulas."""

from ..kinds.table import AGAIN, DARK, FIRST, THROWN_BACK, TRAPPED, Strip, strips_of
from . import principled
from .expression import clamped, sqrt
from .graph import rgba


class Factors:
    """`by_role`: the factors of the strips, or None for 1, by role and metal. `read(strip, label)` reads a
    strip."""

    def __init__(self, lut, inputs, read):
        self._read = read
        thrown_back = [strip for strip in strips_of(lut.header) if strip.role == THROWN_BACK]
        self._base = lut.header["stack"]["base"]
        self._inputs = inputs
        shares = {False: None}
        if len(thrown_back) > 1:
            metallic = clamped(self._input("metallic"))
            shares = {False: (1.0 - metallic).named("1 - m"), True: metallic}
        self.by_role = {(DARK, metal): share for metal, share in shares.items()}
        for strip in thrown_back:
            c, share = self._input("color"), shares[strip.metal]
            once = c if share is None else (share * c).named("once")
            r = self._thrown_back(strip, shares)
            self.by_role[FIRST, strip.metal] = once
            self.by_role[AGAIN, strip.metal] = ((1.0 - r) / (1.0 - r * c) * c * once).named("again")

    def _input(self, name):
        """The value of an input, or the number or color that the stack has."""
        if name in self._base.get("inputs", ()):
            return self._inputs[principled.SOCKETS[name]]
        value = self._base[name]
        return rgba(value)[:3] if name == "color" else float(value[0])

    def _thrown_back(self, strip, shares):
        """r, or for a dielectric that is mixed with metal r' = (1 - m) r + m t."""
        own = self._read(strip, "r")
        if strip.metal or len(shares) == 1:
            return own
        trapped = self._read(Strip(role=TRAPPED), "t")
        return (own * shares[False] + trapped * shares[True]).named("r'")


class Widths:
    """Values that follow the roughness of the base, see lamina.lobes.NodeRecipe."""

    def __init__(self, inputs):
        self._inputs, self._known = inputs, {}

    def of(self, width, factor, power):
        """factor * width ** power, at most 1, with `width` as (scale, least)."""
        width = tuple(width)
        if (width, 1.0, 1.0) not in self._known:
            self._known[width, 1.0, 1.0] = self._width(*width)
        key = (width, factor, power)
        if key not in self._known:
            value = self._known[width, 1.0, 1.0]
            raised = value if power == 1.0 else value**power
            self._known[key] = clamped(raised * factor).named("of width")
        return self._known[key]

    def _width(self, scale, least):
        if "alpha" not in self._known:
            self._known["alpha"] = (clamped(self._inputs["Roughness"]) ** 2).named("alpha")
        scaled = self._known["alpha"] * scale
        return clamped(sqrt(scaled**2 + least**2) if least else scaled).named("width")

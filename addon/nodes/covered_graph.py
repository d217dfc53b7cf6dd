# SPDX-License-Identifier: GPL-3.0-or-later
"""A Principled base below an interface: the factors of the strips of its closures, from the inputs of the
base. See lamina.baking.bases.covered for the formulas."""

from ..kinds.table import AGAIN, DARK, FIRST, THROWN_BACK, TRAPPED, Strip, strips_of
from . import principled
from .graph import rgba


class Factors:
    """`by_role`: the factors of the strips, sockets, or None for 1, by role and metal.

    `read(strip, label)` reads a strip and returns a socket."""

    def __init__(self, graph, lut, inputs, read):
        self._graph, self._read = graph, read
        thrown_back = [strip for strip in strips_of(lut.header) if strip.role == THROWN_BACK]
        self._base = lut.header["stack"]["base"]
        self._inputs = inputs
        shares = {False: None}
        if len(thrown_back) > 1:
            metallic = graph.math("ADD", "metallic", self._input("metallic"), 0.0, clamp=True)
            shares = {False: graph.math("SUBTRACT", "1 - m", 1.0, metallic), True: metallic}
        self.by_role = {(DARK, metal): share for metal, share in shares.items()}
        for strip in thrown_back:
            color, share = self._input("color"), shares[strip.metal]
            once = color if share is None else graph.vector("MULTIPLY", "once", color, share)
            back = self._thrown_back(strip, shares)
            self.by_role[FIRST, strip.metal] = once
            self.by_role[AGAIN, strip.metal] = self._repeated(color, once, back)

    def _input(self, name):
        """The socket of an input, or the number that the stack has."""
        if name in self._base.get("inputs", ()):
            return self._inputs.outputs[principled.SOCKETS[name]]
        value = self._base[name]
        return rgba(value)[:3] if name == "color" else float(value[0])

    def _thrown_back(self, strip, shares):
        """r, or for a dielectric that is mixed with metal r' = (1 - m) r + m t."""
        graph, own = self._graph, self._read(strip, "r")
        if strip.metal or len(shares) == 1:
            return own
        trapped = self._read(Strip(role=TRAPPED), "t")
        kept = graph.scale("m t", trapped, shares[True])
        own = graph.scale("(1 - m) r", own, shares[False])
        return graph.vector("ADD", "r'", own, kept)

    def _repeated(self, color, once, thrown_back):
        """c (1 - r) / (1 - c r) times `once`, the factor of light that is reflected once."""
        graph = self._graph
        leaves = graph.vector("SUBTRACT", "1 - r", (1.0,) * 3, thrown_back)
        again = graph.vector("MULTIPLY", "c r", color, thrown_back)
        rest = graph.vector("SUBTRACT", "1 - c r", (1.0,) * 3, again)
        share = graph.vector("DIVIDE", "(1 - r) / (1 - c r)", leaves, rest)
        part = graph.vector("MULTIPLY", "c", share, color)
        return graph.vector("MULTIPLY", "again", part, once)


class Widths:
    """Values of sockets that follow the roughness of the base, see lamina.lobes.NodeRecipe."""

    def __init__(self, graph, inputs):
        self._graph, self._inputs = graph, inputs
        self._known = {}

    def of(self, width, factor, power):
        """factor * width ** power, at most 1, with `width` as (scale, least)."""
        width = tuple(width)
        if (width, 1.0, 1.0) not in self._known:
            self._known[width, 1.0, 1.0] = self._width(*width)
        key = (width, factor, power)
        if key not in self._known:
            value = self._known[width, 1.0, 1.0]
            if power != 1.0:
                value = self._graph.math("POWER", "power", value, power)
            value = self._graph.math("MULTIPLY", "of width", value, factor, clamp=True)
            self._known[key] = value
        return self._known[key]

    def _width(self, scale, least):
        graph = self._graph
        if "alpha" not in self._known:
            given = self._inputs.outputs["Roughness"]
            rough = graph.math("ADD", "roughness", given, 0.0, clamp=True)
            self._known["alpha"] = graph.math("MULTIPLY", "alpha", rough, rough)
        alpha = self._known["alpha"]
        scaled = graph.math("MULTIPLY", "scaled", alpha, scale, clamp=not least)
        if not least:
            return scaled
        square = graph.math("MULTIPLY", "square", scaled, scaled)
        both = graph.math("ADD", "with the interface", square, least * least)
        return graph.math("SQRT", "width", both, clamp=True)

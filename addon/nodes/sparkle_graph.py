# SPDX-License-Identifier: GPL-3.0-or-later
"""Sparkle of flakes: their lobes fall apart into narrow lobes of cells, with the same mean.

A Glossy BSDF of normal n and widths alpha is a field of facets, whose slopes s have the GGX distribution.
Each cell shows one facet's slope s: a Glossy BSDF of the widths NARROW alpha about n + s. With Smith's
masking G2 and the reflected direction i, the light of a field of facets is the mean over s of
    (n + s).o / n.o  G2(o, i)  times light towards i,
so the cell's weight is that factor times the lobe's own. Slopes of the cells and of their narrow lobes add
up. Their sum has the slopes of the whole lobe if the cells' own have the characteristic function
a k K1(a k) / (b k K1(b k)) with a = alpha and b = NARROW alpha, since a k K1(a k) is that of GGX, Student's t
with two degrees of freedom. There is such a distribution for every b < a, since Student's t is
self-decomposable (Halgreen 1979). Its quantile is near that of GGX, sqrt(u / (1 - u)).

Tilts are those of the lobe as seen from outside: below a coat the lobe, and with it the tilt, is n times as
wide. The share Sparkle of the lobe falls apart. Beyond the Fade Distance, where cells are smaller than a
pixel, this share falls as one over the distance.
"""

import math

from ..kinds.bases import LEAST_ALPHA
from ..kinds.flakes import Flakes
from ..kinds.table import strips_of
from . import mix_shader, rest_coordinates, texture_graph
from .shape_sockets import Shape

SPARKLE, SIZE, DISTANCE = "Sparkle", "Flake Size", "Fade Distance"  # inputs of the group

NARROW = 0.15  # width of a cell's lobe, relative to that of the whole lobe
# a, b, c: the quantile of the cells' slopes for this NARROW is r with r^2 = u / (1 - u) (a + b u + c u^4),
# within 0.4 % of the inverted transform.
SLOPES = 0.8734, 0.048, 0.056
LEAST_COSINE = 1e-4
MOST = 0.999  # u at most, so that no facet stands upright

COLOUR = (0.36, 0.32, 0.16)


def falls_apart(closure):
    """True for the closures of facets that a table has for flakes: those that move, and some of fixed
    width."""
    return closure.startswith(("moving:", "ggx:"))


def is_offered(lut):
    """True if lobes of the table fall apart: those of flakes under smooth boundaries. Cycles samples tilted
    facets rightly where lobes may move."""
    if not lut.header["basis"].startswith("moving") or "azimuth" in lut.header["axes"]:
        return False
    if not any(falls_apart(strip.closure) for strip in strips_of(lut.header)):
        return False
    for layer in lut.header["stack"]["layers"]:
        if layer["kind"] == Flakes.kind:
            return True
        if layer["kind"] == "interface" and max(layer["alpha"]) >= LEAST_ALPHA:
            return False  # its lobe is one of those that move
    return False


class Sparkle:
    """The cells of a surface; `over` gives a closure its sparkle. `inputs`: the group's input node."""

    def __init__(self, graph, inputs, directions):
        self._graph, self._directions = graph, directions
        graph.begin_frame("Sparkle: a random direction and slope for each cell", COLOUR)
        place = rest_coordinates.draw(graph)
        scale = graph.math("DIVIDE", "per length", 1.0, inputs.outputs[SIZE])
        cells = texture_graph.points(graph, place, scale)
        # The color of a cell is also the place of its point in a lattice, so it depends on the cell's size.
        chance = graph.node("ShaderNodeTexWhiteNoise", "of each cell")
        chance.noise_dimensions = "3D"
        graph.link(cells.outputs["Color"], chance.inputs["Vector"])
        height, turn, share = graph.separate("u", chance.outputs["Color"])
        self._tilt_of(height, turn, share)
        camera = graph.node("ShaderNodeCameraData")
        away = camera.outputs["View Distance"]
        near = graph.math("DIVIDE", "near", inputs.outputs[DISTANCE], away)
        near = graph.math("MINIMUM", "at most 1", near, 1.0)
        self._share = graph.math("MULTIPLY", "share that sparkles", inputs.outputs[SPARKLE], near)
        graph.end_frame()

    def _tilt_of(self, height, turn, share):
        """Sets `_direction`, a random one of the whole sphere, whose azimuth about any normal is random, and
        `_slope`, for widths of 1."""
        graph = self._graph
        up = graph.math("MULTIPLY_ADD", "z", height, 2.0, -1.0)
        around = graph.math("MULTIPLY", "azimuth", turn, 2.0 * math.pi)
        down = graph.math("MULTIPLY", "-z", up, -1.0)
        ring = graph.math("MULTIPLY_ADD", "1 - z^2", up, down, 1.0)
        ring = graph.math("SQRT", "ring", ring)
        direction = graph.node("ShaderNodeCombineXYZ", "random direction")
        for number, how in enumerate(("COSINE", "SINE")):
            part = graph.math(how, how.lower(), around)
            graph.link(graph.math("MULTIPLY", "part", part, ring), direction.inputs[number])
        graph.link(up, direction.inputs[2])
        self._direction = direction.outputs[0]
        share = graph.math("MINIMUM", "u", share, MOST)
        rest = graph.math("SUBTRACT", "1 - u", 1.0, share)
        odds = graph.math("DIVIDE", "u / (1 - u)", share, rest)
        square = graph.math("MULTIPLY", "u^2", share, share)
        rise = graph.math("MULTIPLY", "u^4", square, square)
        rise = graph.math("MULTIPLY_ADD", "steep", rise, SLOPES[2], SLOPES[0])
        square = graph.math("MULTIPLY_ADD", "all", share, SLOPES[1], rise)
        square = graph.math("MULTIPLY", "r^2", odds, square)
        self._slope = graph.math("SQRT", "slope", square)

    def over(self, closure, shape, weight, node):
        """The shader of the Glossy BSDF `node`, whose share Sparkle falls apart. `shape`: its Shape, or None
        if it is fixed; `weight`: the socket of its color."""
        graph = self._graph
        shape = shape or Shape(node.inputs["Roughness"].default_value, 0.0, self._directions.of("N"))
        outer = graph.frame
        graph.begin_frame(f"Sparkle of {closure}", COLOUR)
        facets = _Facets(graph, shape, self._directions)
        tilted, x = facets.tilted(self._direction, self._slope)
        factor = facets.weight(tilted)
        cell = graph.node(node.bl_idname, f"cells {closure}")
        cell.distribution = node.distribution
        narrow = graph.math("MULTIPLY", "narrow", shape.roughness, math.sqrt(NARROW))
        weight = graph.scale("weight", weight, factor)
        for name, socket in (("Color", weight), ("Roughness", narrow), ("Anisotropy", shape.anisotropy),
                             ("Normal", tilted), ("Tangent", x)):
            graph.set(cell.inputs[name], socket)
        for socket in cell.inputs:
            socket.hide = not socket.is_linked
        graph.frame = outer
        shaders = node.outputs[0], cell.outputs[0]
        return mix_shader.between(graph, "lobe or cells", self._share, *shaders)


class _Facets:
    """The field of facets of a Glossy BSDF: its widths, and its frame X, Y, n with X in the plane of
    incidence."""

    def __init__(self, graph, shape, directions):
        self._graph, self._view = graph, directions.of("I")
        self._n = graph.vector("NORMALIZE", "n", shape.normal)
        cosine = graph.vector("DOT_PRODUCT", "n.o", self._n, self._view)
        self._cosine = graph.math("MAXIMUM", "n.o", cosine, LEAST_COSINE)
        across = graph.vector("CROSS_PRODUCT", "across", self._n, directions.of("I aside"))
        self._y = graph.vector("NORMALIZE", "Y", across)
        self._x = graph.vector("CROSS_PRODUCT", "X", self._y, self._n)
        mean = graph.math("MULTIPLY", "alpha", shape.roughness, shape.roughness)
        size = graph.math("ABSOLUTE", "|a|", shape.anisotropy)
        rest = graph.math("SUBTRACT", "1 - |a|", 1.0, size)
        squeeze = graph.math("POWER", "squeeze", rest, graph.math("SIGN", "sign", shape.anisotropy))
        self._alpha_x = graph.math("MULTIPLY", "alpha x", mean, squeeze, clamp=True)
        self._alpha_y = graph.math("DIVIDE", "alpha y", mean, squeeze, clamp=True)

    def tilted(self, direction, slope):
        """(the vector n + s of a facet of this direction and slope, X): sockets."""
        graph = self._graph
        parts = [graph.vector("DOT_PRODUCT", "part", direction, axis) for axis in (self._x, self._y)]
        square = graph.math("MULTIPLY", "square", parts[1], parts[1])
        square = graph.math("MULTIPLY_ADD", "square", parts[0], parts[0], square)
        length = graph.math("SQRT", "length", square)
        slope = graph.math("DIVIDE", "slope", slope, length)
        facet = self._n
        axes = (self._x, self._y), (self._alpha_x, self._alpha_y)
        for part, axis, alpha in zip(parts, *axes, strict=True):
            wide = graph.math("MULTIPLY", "wide", part, alpha)
            wide = graph.math("MULTIPLY", "tilt", wide, slope)
            facet = graph.vector("ADD", "n + s", facet, graph.scale("along", axis, wide))
        return facet, self._x

    def weight(self, tilted):
        """(n + s).o / n.o G2(o, i), with G2 = 2 / (R(o) + R(i)), R = sqrt(1 + (alpha tan)^2); almost 0 if i
        is below."""
        graph = self._graph
        seen = graph.vector("DOT_PRODUCT", "(n + s).o", tilted, self._view)
        seen = graph.math("MAXIMUM", "seen", seen, 0.0)
        mirrored = graph.vector("REFLECT", "-i", self._view, tilted)
        height = graph.math("MULTIPLY", "n.i", -1.0, graph.vector("DOT_PRODUCT", "-n.i", self._n, mirrored))
        height = graph.math("MAXIMUM", "n.i", height, LEAST_COSINE)
        both = graph.math("ADD", "R + R", self._root(self._view, self._cosine), self._root(mirrored, height))
        masked = graph.math("MULTIPLY", "masked", both, self._cosine)
        twice = graph.math("MULTIPLY", "twice", seen, 2.0)
        return graph.math("DIVIDE", "weight", twice, masked)

    def _root(self, direction, cosine):
        graph, sum = self._graph, 0.0
        for axis, alpha in ((self._x, self._alpha_x), (self._y, self._alpha_y)):
            part = graph.vector("DOT_PRODUCT", "part", axis, direction)
            part = graph.math("MULTIPLY", "alpha part", part, alpha)
            part = graph.math("DIVIDE", "alpha tan", part, cosine)
            sum = graph.math("MULTIPLY_ADD", "square", part, part, sum)
        return graph.math("SQRT", "R", graph.math("ADD", "1 + square", sum, 1.0))

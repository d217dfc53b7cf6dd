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
from . import rest_coordinates, texture_graph
from .expression import clamped, cosine, cross, dot, maximum, minimum, normalized, reflected, sign, sine, sqrt
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
    """The cells of a surface; `over` gives a closure its sparkle. `inputs`: the group's."""

    def __init__(self, graph, inputs, directions):
        self._graph, self._directions = graph, directions
        graph.begin_frame("Sparkle: a random direction and slope for each cell", COLOUR)
        place = rest_coordinates.draw(graph)
        cells = texture_graph.points(graph, place, 1.0 / inputs[SIZE])
        # The color of a cell is also the place of its point in a lattice, so it depends on the cell's size.
        chance = graph.node("ShaderNodeTexWhiteNoise", "of each cell")
        chance.noise_dimensions = "3D"
        graph.link(cells.outputs["Color"], chance.inputs["Vector"])
        height, turn, share = graph.separate("u", chance.outputs["Color"])
        self._tilt_of(height, turn, share)
        away = graph.values(graph.node("ShaderNodeCameraData"))["View Distance"]
        self._share = (inputs[SPARKLE] * minimum(inputs[DISTANCE] / away, 1.0)).named("share that sparkles")
        graph.end_frame()

    def _tilt_of(self, height, turn, share):
        """Sets `_direction`, a random one of the whole sphere, whose azimuth about any normal is random, and
        `_slope`, for widths of 1."""
        z, azimuth = height * 2.0 - 1.0, turn * (2.0 * math.pi)
        ring = sqrt(1.0 - z**2)
        parts = cosine(azimuth) * ring, sine(azimuth) * ring, z
        self._direction = self._graph.combined("random direction", *parts)
        u = minimum(share, MOST).named("u")
        a, b, c = SLOPES
        self._slope = sqrt(u / (1.0 - u) * (a + b * u + c * (u**2) ** 2)).named("slope")

    def over(self, closure, shape, weight, node):
        """The shader of the Glossy BSDF `node`, whose share Sparkle falls apart. `shape`: its Shape, or None
        if it is fixed; `weight`: its color."""
        graph = self._graph
        shape = shape or Shape(node.inputs["Roughness"].default_value, 0.0, self._directions.of("N"))
        outer = graph.frame
        graph.begin_frame(f"Sparkle of {closure}", COLOUR)
        facets = _Facets(shape, self._directions)
        tilted = facets.tilted(self._direction, self._slope)
        factor = facets.weight(tilted)
        cell = graph.node(node.bl_idname, f"cells {closure}")
        cell.distribution = node.distribution
        given = {"Color": weight * factor, "Roughness": shape.roughness * math.sqrt(NARROW),
                 "Anisotropy": shape.anisotropy, "Normal": tilted, "Tangent": facets.x}
        for name, value in given.items():
            graph.set(cell.inputs[name], value)
        for socket in cell.inputs:
            socket.hide = not socket.is_linked
        graph.frame = outer
        shaders = node.outputs[0], cell.outputs[0]
        return graph.mix_shaders("lobe or cells", self._share, *shaders)


class _Facets:
    """The field of facets of a Glossy BSDF: its widths, and its frame X, Y, n with X in the plane of
    incidence."""

    def __init__(self, shape, directions):
        self._view = directions.of("I")
        self._n = normalized(shape.normal).named("n")
        self._cosine = maximum(dot(self._n, self._view), LEAST_COSINE).named("n.o")
        y = normalized(cross(self._n, directions.of("I aside"))).named("Y")
        self.x = cross(y, self._n).named("X")
        alpha, a = shape.roughness**2, shape.anisotropy
        squeeze = 1.0 if a == 0.0 else (1.0 - abs(a)) ** sign(a)
        self._axes = (self.x, clamped(alpha * squeeze)), (y, clamped(alpha / squeeze))

    def tilted(self, direction, slope):
        """The vector n + s of a facet of this direction and slope."""
        x, y = (dot(direction, axis) for axis, _ in self._axes)
        slope = slope / sqrt(x**2 + y**2)
        facet = self._n
        for part, (axis, alpha) in zip((x, y), self._axes, strict=True):
            facet += axis * (part * alpha * slope)
        return facet.named("n + s")

    def weight(self, tilted):
        """(n + s).o / n.o G2(o, i), with G2 = 2 / (R(o) + R(i)), R = sqrt(1 + (alpha tan)^2); almost 0 if i
        is below."""
        mirrored = reflected(self._view, tilted).named("-i")
        height = maximum(-dot(self._n, mirrored), LEAST_COSINE).named("n.i")
        both = self._root(self._view, self._cosine) + self._root(mirrored, height)
        return (maximum(dot(tilted, self._view), 0.0) * 2.0 / (both * self._cosine)).named("weight")

    def _root(self, direction, cosine):
        x, y = (dot(axis, direction) * alpha / cosine for axis, alpha in self._axes)
        return sqrt(1.0 + x**2 + y**2).named("R")

# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes inside a material's group: those of its table, or of two tables, which the coverage of a film
mixes. Those of a table are a sum of closures, each weighted by its own strip, and what lies below the
layers."""

import numpy as np

from ..base import native
from ..kinds.table import BASE, BASE_WEIGHT, PRINCIPLED, THROWN_BACK, Strip, is_covered, strips_of
from . import (
    base_graph,
    covered_graph,
    eevee_graph,
    lut_image,
    sparkle_graph,
    table_view,
    thin_sheet,
)
from .closure_directions import Directions, UnknownClosureError
from .expression import clamped
from .graph import Graph
from .group_sockets import COVERAGE
from .shape_sockets import Shapes
from .strip_reader import Reader

BASE_COLOUR = (0.34, 0.20, 0.16)
CLOSURE_COLOUR = (0.30, 0.24, 0.16)


def used_closures(lut):
    """Indices of the closures with a weight above 0 anywhere; at least one, so that the group has a
    shader."""
    used = np.flatnonzero(np.any(np.asarray(lut.weights) != 0.0, axis=(0, 2, 3, 4)))
    lobes = [index for index, strip in enumerate(strips_of(lut.header)) if strip.is_weight]
    return [int(index) for index in used if int(index) in lobes] or lobes[:1]


def draw(tree, tables, image, recipe_of):
    """Add the whole graph of the `tables` in `image`, see lut_image, to `tree`. `recipe_of(closure id)` ->
    NodeRecipe. Returns the Graph.

    Each table gets all nodes: Cycles merges nodes that are equal. Removes all added nodes if it fails. Raises
    UnknownClosureError.
    """
    graph, shaders = Graph(tree), []
    try:
        for table in tables:
            shaders.append(_draw_table(graph, table, image, recipe_of))
        _output(graph, tables[0].lut, shaders)
        graph.arrange()
    except BaseException:
        graph.remove_created()
        raise
    return graph


def _output(graph, lut, shaders):
    """Feed the group's output: the shader of the table, or its mixture with that without the film."""
    total = shaders[0]
    if len(shaders) > 1:
        inputs = graph.values(graph.node("NodeGroupInput", folded=False))
        coverage = clamped(inputs[COVERAGE]).named("coverage")
        total = graph.mix_shaders("without or with the film", coverage, shaders[1], total)
    output = graph.node("NodeGroupOutput", folded=False)
    output.is_active_output = True
    graph.link(total, output.inputs["Shader"])
    thin_sheet.draw(graph, lut, output)


def _draw_table(graph, table, image, recipe_of):
    """Add the nodes of one Table in `image`, see lut_image, to the Graph `graph`, and return its shader.
    `recipe_of(closure id)` -> NodeRecipe. Raises UnknownClosureError."""
    strips = strips_of(table.lut.header)
    kept = [strips[index] for index in used_closures(table.lut)]
    same_closure = _by_closure(kept, metals_apart=not is_covered(strips))
    sums = [(same, recipe_of(same[0].closure)) for same in same_closure]
    view = table_view.draw(graph, table.lut, table.height)
    directions = _directions(graph, view, [recipe for _, recipe in sums])
    drawing = _Drawing(graph, table, strips, view, Reader(graph, table, image, view))
    factors = drawing.factors()
    totals = drawing.totals(sums, factors, directions)
    total = drawing.over_base(drawing.for_eevee(totals, factors))
    graph.end_frame()
    return total


def _directions(graph, view, recipes):
    """The Directions that the recipes use."""
    graph.begin_frame("Directions of the closures", table_view.NORMAL_COLOUR)
    directions = Directions(view.incoming, view.normal, view.cosine, view.angle, view.tangent)
    for recipe in recipes:
        for wanted in (recipe.normal, *recipe.vectors.values()):
            directions.of(wanted)
        for multiple in recipe.view_angles.values():
            directions.view_angle(multiple)
        for parameters in recipe.of_cosine.values():
            directions.of_cosine(*parameters)
    return directions


class _Drawing:
    """The shader of a table, from its strips to what lies below the layers."""

    def __init__(self, graph, table, strips, view, reader):
        self._graph, self._lut, self._eevee = graph, table.lut, table.eevee
        self._strips, self._view, self._reader = strips, view, reader
        self._covered = is_covered(strips)

    def factors(self):
        """{(role, metal): value} by which strips of a base below are multiplied."""
        graph, inputs, factors = self._graph, self._view.inputs, {}
        if self._covered:
            graph.begin_frame("Factors of the base below: metallic, and color, again and again", BASE_COLOUR)
            return covered_graph.Factors(self._lut, inputs, self._reader.read).by_role
        if Strip(role=BASE_WEIGHT) in self._strips:
            return factors
        for thrown_back in (strip for strip in self._strips if strip.role == THROWN_BACK):
            graph.begin_frame("Base color c, thrown back again and again: c / (1 - c r)", BASE_COLOUR)
            c, r = inputs["Base Color"], self._reader.of_both(thrown_back, "r")
            factors[BASE, thrown_back.metal] = (c / (1.0 - c * r)).named("c / (1 - c r)")
        return factors

    def totals(self, sums, factors, directions):
        """{metal: shader}: the sum of the closures, those of a metal apart. `sums`: (strips of one closure,
        its recipe)."""
        graph, read, chooser = self._graph, self._reader.read, self._reader.chooser
        sparkle = None
        if sparkle_graph.is_offered(self._lut):
            sparkle = sparkle_graph.Sparkle(graph, self._view.inputs, directions)
        graph.begin_frame("Closures, each weighted by its own strip of the table", CLOSURE_COLOUR)
        widths = covered_graph.Widths(self._view.inputs)
        shapes = Shapes(graph, read, directions)
        totals = {}
        for same, recipe in sums:
            closure = same[0].closure
            weight = _weighted(same, read, factors)
            if recipe.weight_input == "Coat Tint":
                weight = eevee_graph.dark(graph, chooser, weight)
            elif self._covered:
                albedo = native.part("baking.table.real_time").shown_as_diffuse(closure)
                weight = eevee_graph.scaled(graph, chooser, weight, albedo)
            name, metal = (closure, False) if self._covered else (same[0].name, same[0].metal)
            shader = _closure(graph, name, recipe, weight, directions, widths, shapes)
            if sparkle is not None and sparkle_graph.falls_apart(closure):
                shader = sparkle.over(name, shapes.by_closure.get(name), weight, shader.node)
            if metal in totals:
                shader = graph.add_shaders("", totals[metal], shader)
            totals[metal] = shader
        return totals

    def for_eevee(self, totals, factors):
        """The totals, or those of Eevee's own closures where Eevee renders."""
        if not self._eevee.strips:
            return totals
        graph, view, reader = self._graph, self._view, self._reader
        graph.begin_frame("Closures for Eevee, which has few kinds", CLOSURE_COLOUR)
        shown = eevee_graph.totals(
            graph, self._lut, self._eevee, reader.texels, factors, view.normal, view.incoming)
        totals = {metal: eevee_graph.chosen(graph, reader.chooser, total, shown[metal])
                  for metal, total in totals.items()}
        graph.end_frame()
        return totals

    def over_base(self, totals):
        """The shader of the layers and of a Principled BSDF or another shader below."""
        graph, reader, inputs = self._graph, self._reader, self._view.inputs
        total, principled, shader_weight = totals[False], Strip(role=PRINCIPLED), Strip(role=BASE_WEIGHT)
        if principled in self._strips:
            graph.begin_frame("Principled BSDF below, as the layers leave it", BASE_COLOUR)
            if True in totals:
                both = inputs["Metallic"], total, totals[True]
                total = graph.mix_shaders("dielectric or metal", *both)
            held = reader.alpha(lut_image.holder_of_principled(self._lut), "w")
            weight = reader.of_both(principled, "w", held)
            total = base_graph.with_principled(graph, self._lut, inputs, self._view.normal, weight, total)
        if shader_weight in self._strips:
            graph.begin_frame(
                "Shader below, its light thrown back again and again: w / (1 - c r)", BASE_COLOUR)
            r, w = reader.of_both(Strip(role=THROWN_BACK), "r"), reader.of_both(shader_weight, "w")
            weight = w / (1.0 - inputs[base_graph.REFLECTANCE] * r)
            total = base_graph.with_shader(graph, inputs, weight.named("w / (1 - c r)"), total)
        return total


def _by_closure(strips, metals_apart):
    """The strips, in lists of one closure each. `metals_apart`: closures of a metal stay apart, since Cycles
    leaves those out where Metallic is 0."""
    found = {}
    for strip in strips:
        found.setdefault((metals_apart and strip.metal, strip.closure), []).append(strip)
    return list(found.values())


def _weighted(strips, read, factors):
    """The sum of the strips, each times its factor in `factors`, by role and metal, or None for 1.

    `read(strip, label)` reads a strip."""
    total = 0.0
    for strip in strips:
        weight, factor = read(strip, f"weight {strip.name}"), factors.get((strip.role, strip.metal))
        total = (weight if factor is None else weight * factor) + total
    return total


def _closure(graph, name, recipe, weight, directions, widths, shapes):
    try:
        node = graph.node(recipe.type, name)
        for key, value in recipe.enums.items():
            setattr(node, key, value)
        for key, value in recipe.inputs.items():
            node.inputs[key].default_value = value
        graph.link(weight, node.inputs[recipe.weight_input])
        # An unlinked socket means the plain N, unless the group was given a normal: always link it.
        if recipe.normal_input in node.inputs and not recipe.moves:
            graph.link(directions.of(recipe.normal), node.inputs[recipe.normal_input])
        for key, wanted in recipe.vectors.items():
            graph.link(directions.of(wanted), node.inputs[key])
        for key, multiple in recipe.view_angles.items():
            graph.link(directions.view_angle(multiple), node.inputs[key])
        for key, parameters in recipe.of_cosine.items():
            graph.link(directions.of_cosine(*parameters), node.inputs[key])
        for key, (factor, power) in recipe.of_width.items():
            graph.link(widths.of(recipe.width, factor, power), node.inputs[key])
        if recipe.moves:
            shapes.link(node, name, recipe.turns)
        for socket in node.inputs:
            socket.hide = not socket.is_linked  # a folded node grows with every visible socket
    except (KeyError, TypeError, RuntimeError) as error:
        raise UnknownClosureError(f"closure {name}: this Blender cannot build it ({error})") from error
    return node.outputs[0]

# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes of one table inside a material's group: from the view angle to a sum of weighted closures.

u = (theta_o / (pi/2) * 63 + .5) / 64 and v = (strip * rows + t * (rows - 1) + .5) / height address the
texel centres of the LUT (see lamina.Lut). Each texture's own mapping computes u and adds the strip: Cycles
runs one instruction for a mapping, and two for a node with a constant. Every closure reads its own strip; the
strips of a sheet's bottom side follow those of its top side, and back faces read them. Cycles has already
turned the normal towards the viewer there.
"""

import math

import numpy as np

from ..base import native
from ..kinds.table import BASE, BASE_WEIGHT, PRINCIPLED, TAU_BEND, THROWN_BACK, Strip, is_covered, strips_of
from . import (
    azimuth_graph,
    covered_graph,
    eevee_graph,
    eevee_lookup,
    lut_image,
    mix_shader,
    principled_graph,
    roughness_graph,
    shader_base_graph,
    side_graph,
    sparkle_graph,
)
from .closure_directions import Directions, UnknownClosureError
from .shape_sockets import Shapes

SCALE_LABEL = "rows"

ANGLE_COLOUR = (0.16, 0.24, 0.34)
NORMAL_COLOUR = (0.20, 0.20, 0.36)
ROW_COLOUR = (0.18, 0.30, 0.24)
BASE_COLOUR = (0.34, 0.20, 0.16)
CLOSURE_COLOUR = (0.30, 0.24, 0.16)


def used_closures(lut):
    """Indices of the closures with a weight above 0 anywhere; at least one, so that the group has a
    shader."""
    used = np.flatnonzero(np.any(np.asarray(lut.weights) != 0.0, axis=(0, 2, 3, 4)))
    lobes = [index for index, strip in enumerate(strips_of(lut.header)) if strip.is_weight]
    return [int(index) for index in used if int(index) in lobes] or lobes[:1]


def roughness_rows(lut):
    """The number of roughnesses of the table, 1 without such an axis."""
    return lut.header["axes"].get("roughness", {}).get("count", 1)


def largest_tau(lut):
    """The varying layer's optical thickness at the last row, or None if no layer varies."""
    axis = lut.header["axes"]["tau"]
    return float(axis["values"][-1]) if axis["count"] > 1 else None


def draw(graph, table, image, recipe_of):
    """Add the nodes of one Table in `image`, see lut_image, to the Graph `graph`, and return its shader.
    `recipe_of(closure id)` -> NodeRecipe. Raises UnknownClosureError."""
    lut, eevee, height = table.lut, table.eevee, table.height
    rows = lut.header["axes"]["tau"]["count"]
    strip_rows = rows * roughness_rows(lut) * azimuth_graph.rows(lut)
    strips = strips_of(lut.header)
    columns = lut.header["axes"]["view"]["count"]
    covered = is_covered(strips)
    sums = _by_closure([strips[index] for index in used_closures(lut)], metals_apart=not covered)
    recipes = [recipe_of(same[0].closure) for same in sums]

    inputs = graph.node("NodeGroupInput", -2.2, 2, folded=False)
    geometry = graph.node("ShaderNodeNewGeometry", -2.2, 6, folded=False)
    incoming = geometry.outputs["Incoming"]
    backfacing = geometry.outputs["Backfacing"]

    graph.begin_frame("Normal (the surface's own when the input is empty)", NORMAL_COLOUR)
    normal = normal_of(graph, inputs.outputs["Normal"], geometry.outputs["Normal"])
    graph.begin_frame("View angle", ANGLE_COLOUR)
    cosine = graph.vector("DOT_PRODUCT", -0.6, 4, "view cosine", incoming, normal)
    angle = graph.math("ARCCOSINE", 0.4, 4, "view angle", cosine)
    graph.begin_frame("Thickness and side to row v", ROW_COLOUR)
    v, tangent, turn = _row(graph, lut, inputs, backfacing, rows, height), None, None
    if azimuth_graph.rows(lut) > 1:
        graph.begin_frame("Azimuth of the view from the tangent to row v", ROW_COLOUR)
        tangent, azimuth = azimuth_graph.draw(graph, lut, inputs, normal, incoming)
        per_radian = (azimuth_graph.rows(lut) - 1) / math.pi
        if rows == 1:
            v = graph.math("MULTIPLY_ADD", 9.4, 22, "v of the azimuth", azimuth, per_radian / height, v)
        else:
            turn = graph.math("MULTIPLY", 9.4, 22, "row of the azimuth", azimuth, per_radian)
    graph.end_frame()
    corner = graph.node("ShaderNodeCombineXYZ", 5.6, 3, "view angle, v")
    graph.set(corner.inputs[0], angle)
    graph.set(corner.inputs[1], v)

    graph.begin_frame("Directions of the closures", NORMAL_COLOUR)
    directions = Directions(graph, incoming, normal, cosine, angle, tangent)
    for recipe in recipes:
        for wanted in (recipe.normal, *recipe.vectors.values()):
            directions.of(wanted)
        for multiple in recipe.view_angles.values():
            directions.view_angle(multiple)
        for parameters in recipe.of_cosine.values():
            directions.of_cosine(*parameters)

    textures = {}

    def look_up(corner, index, column, line, label):
        texture = graph.node("ShaderNodeTexImage", column + 1, line, label)
        texture.image = image
        texture.interpolation, texture.extension = "Linear", "EXTEND"
        texture.texture_mapping.scale = ((columns - 1) / columns / (math.pi / 2), 1.0, 1.0)
        row = table.first + index * strip_rows
        texture.texture_mapping.translation = (0.5 / columns, (row + 0.5) / height, 0.0)
        graph.link(corner, texture.inputs[0])
        textures.setdefault(index, []).append(texture)
        return texture.outputs["Color"]

    place, step = corner.outputs[0], rows / height
    if turn is None:
        around = roughness_graph.around(graph, inputs, place, v, roughness_rows(lut), step, rows == 1)
    else:
        around = roughness_graph.between(graph, turn, place, v, azimuth_graph.rows(lut), step)

    def read(strip, column, line, label):
        index = strips.index(strip)
        if around.share is None:
            return look_up(around.corners[0], index, column, line, label)
        lower, upper = (look_up(one, index, column, line, label) for one in around.corners)
        return graph.mix("VECTOR", column + 1.6, line, "between", around.share, lower, upper)

    graph.begin_frame("Texels for Eevee", ANGLE_COLOUR)
    chooser = eevee_graph.is_eevee(graph)
    texels = eevee_lookup.Texels(graph, image, angle, columns, height, strip_rows, around, table.first)

    def of_both(strip, line, label, number=None):
        """A strip that Cycles and Eevee share. `number`: where Cycles finds it, if not in the strip."""
        value = read(strip, 7, line, label) if number is None else number
        (exact,) = texels.read(strips.index(strip), 7, line, f"{eevee_graph.LABEL} {label}", alpha=False)
        kind = "RGBA" if number is None else "FLOAT"
        return eevee_graph.chosen_value(graph, line, chooser, value, exact, kind)

    shader_weight = Strip(role=BASE_WEIGHT)
    factors = {}
    for thrown_back in (strip for strip in strips if strip.role == THROWN_BACK):
        if shader_weight not in strips and not covered:
            graph.begin_frame("Base color c, thrown back again and again: c / (1 - c r)", BASE_COLOUR)
            line, colour = -6 if thrown_back.metal else -3, inputs.outputs["Base Color"]
            back = of_both(thrown_back, line, "r")
            gain = _again_and_again(graph, line, "c / (1 - c r)", colour, colour, back)
            factors[BASE, thrown_back.metal] = gain
    if covered:
        graph.begin_frame("Factors of the base below: metallic, and color, again and again", BASE_COLOUR)
        factors = covered_graph.Factors(graph, lut, inputs, read).by_role

    sparkle = sparkle_graph.Sparkle(graph, inputs, directions) if sparkle_graph.is_offered(lut) else None
    graph.begin_frame("Closures, each weighted by its own strip of the table", CLOSURE_COLOUR)
    widths = covered_graph.Widths(graph, inputs)
    shapes = Shapes(graph, read, directions)
    totals = {}
    for line, (same, recipe) in enumerate(zip(sums, recipes, strict=True)):
        closure = same[0].closure
        weight = _weighted(graph, line, same, read, factors)
        if recipe.weight_input == "Coat Tint":
            weight = eevee_graph.dark(graph, line, chooser, weight)
        elif covered:
            albedo = native.part("baking.table.real_time").shown_as_diffuse(closure)
            weight = eevee_graph.scaled(graph, line, chooser, weight, albedo)
        name, metal = (closure, False) if covered else (same[0].name, same[0].metal)
        shader = _closure(graph, line, name, recipe, weight, directions, widths, shapes)
        if sparkle is not None and sparkle_graph.falls_apart(closure):
            shader = sparkle.over(name, shapes.by_closure.get(name), weight, shader.node)
        if metal in totals:
            shader = mix_shader.added(graph, 12, line, "", totals[metal], shader)
        totals[metal] = shader
    if eevee.strips:
        graph.begin_frame("Closures for Eevee, which has few kinds", CLOSURE_COLOUR)
        shown = eevee_graph.totals(graph, lut, eevee, texels, factors, normal, incoming)
        totals = {metal: eevee_graph.chosen(graph, -4 if metal else -5, chooser, total, shown[metal])
                  for metal, total in totals.items()}
        graph.end_frame()
    total, principled = totals[False], Strip(role=PRINCIPLED)
    if principled in strips:
        graph.begin_frame("Principled BSDF below, as the layers leave it", BASE_COLOUR)
        if True in totals:
            metallic = inputs.outputs["Metallic"]
            total = mix_shader.between(graph, 12.6, -2, "dielectric or metal", metallic, total, totals[True])
        holder = lut_image.holder_of_principled(lut)
        if strips.index(holder) not in textures:
            read(holder, 7, -2, "w")
        held = [texture.outputs["Alpha"] for texture in textures[strips.index(holder)]]
        held = held[0] if len(held) == 1 else graph.mix("FLOAT", 8.6, -2, "between", around.share, *held)
        weight = of_both(principled, -2, "w", held)
        total = principled_graph.beside(graph, lut, inputs, normal, weight, total)
    if shader_weight in strips:
        graph.begin_frame("Shader below, its light thrown back again and again: w / (1 - c r)", BASE_COLOUR)
        thrown_back = of_both(Strip(role=THROWN_BACK), -3, "r")
        weight = of_both(shader_weight, -2, "w")
        colour = inputs.outputs[shader_base_graph.REFLECTANCE]
        weight = _again_and_again(graph, -3, "w / (1 - c r)", weight, colour, thrown_back)
        total = shader_base_graph.over(graph, inputs, weight, total)
    graph.end_frame()
    return total


def _by_closure(strips, metals_apart):
    """The strips, in lists of one closure each. `metals_apart`: closures of a metal stay apart, since Cycles
    leaves those out where Metallic is 0."""
    found = {}
    for strip in strips:
        found.setdefault((metals_apart and strip.metal, strip.closure), []).append(strip)
    return list(found.values())


def _weighted(graph, line, strips, read, factors):
    """The sum of the strips, each times its factor in `factors`, by role and metal: a socket, or None for 1.

    `read(strip, column, line, label)` reads a strip and returns a socket."""
    total = None
    for number, strip in enumerate(strips):
        place = line + 0.2 * number
        weight, factor = read(strip, 7, place, f"weight {strip.name}"), factors.get((strip.role, strip.metal))
        if factor is None:
            total = weight if total is None else graph.vector("ADD", 9.2, place, "sum", weight, total)
        elif total is None:
            total = graph.vector("MULTIPLY", 9.2, place, "part", weight, factor)
        else:
            total = graph.vector("MULTIPLY_ADD", 9.2, place, "sum", weight, factor, total)
    return total


def _again_and_again(graph, line, label, weight, colour, thrown_back):
    """w / (1 - c r), the sum of w (c r)^n: a base of color c reflects what the layers throw back, r."""
    again = graph.vector("MULTIPLY", 9.2, line, "c r", colour, thrown_back)
    rest = graph.vector("SUBTRACT", 10.2, line, "1 - c r", (1.0, 1.0, 1.0), again)
    return graph.vector("DIVIDE", 11.2, line, label, weight, rest)


def normal_of(graph, given, own):
    """The group's Normal input, or the surface's normal while nothing is linked to it (a zero vector)."""
    length = graph.vector("LENGTH", -0.6, 0, "length", given)
    is_given = graph.math("GREATER_THAN", 0.4, 0, "is given", length, 0.5)
    chosen = graph.mix("VECTOR", 1.4, 1, "normal", is_given, own, given)
    return graph.vector("NORMALIZE", 2.4, 1, "N", chosen)


def _row(graph, lut, inputs, backfacing, rows, height):
    """v of strip 0 without the half texel, which each strip adds."""
    tau, side = None, backfacing
    if rows > 1:
        most, scale = _thickness_scale(lut, rows, height)
        tau, side = side_graph.draw(graph, lut, inputs, backfacing, most)
    first = 0.0
    if len(lut.header["sides"]) > 1:
        strips = len(lut.header["closures"])
        first = graph.math("MULTIPLY", 4.4, 8.2, "bottom side's strips", side, strips * rows / height)
    if rows == 1:
        return graph.math("ADD", 5.4, 8.2, "v", first, 0.0)
    shifted = graph.math("ADD", 3.4, 8.2, "tau + 1/2", tau, TAU_BEND)
    share = graph.math("DIVIDE", 3.4, 7, "tau / (tau + 1/2)", tau, shifted)
    row = graph.math("MULTIPLY", 4.4, 7, SCALE_LABEL, share, scale)
    return graph.math("ADD", 5.4, 7, "v", row, first)


def _thickness_scale(lut, rows, height):
    """(largest thickness in the table, factor from tau / (tau + 1/2) to v)."""
    largest = largest_tau(lut)
    last = 1.0 if math.isinf(largest) else largest / (largest + TAU_BEND)
    return min(largest, 1.0e30), (rows - 1) / height / last if last else 0.0


def rescale(tree, table):
    """Changes a drawn tree to the thickness axis of another table of the same layout."""
    rows = table.lut.header["axes"]["tau"]["count"]
    if rows > 1:
        most, scale = _thickness_scale(table.lut, rows, table.height)
        values = {side_graph.MOST_LABEL: most, SCALE_LABEL: scale}
        for node in tree.nodes:
            if node.type == "MATH" and node.label in values:
                node.inputs[1].default_value = values[node.label]


def _closure(graph, line, name, recipe, weight, directions, widths, shapes):
    try:
        node = graph.node(recipe.type, 10.6, line, name)
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
            shapes.link(node, name, line, recipe.turns)
        for socket in node.inputs:
            socket.hide = not socket.is_linked  # a folded node grows with every visible socket
    except (KeyError, TypeError, RuntimeError) as error:
        raise UnknownClosureError(f"closure {name}: this Blender cannot build it ({error})") from error
    return node.outputs[0]

# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes inside a material's group: those of its table, or of two tables, which the coverage of a film
mixes."""

from . import closure_graph, mix_shader, thin_sheet
from .expression import clamped
from .graph import Graph
from .group_sockets import COVERAGE


def draw(tree, tables, image, recipe_of):
    """Add the whole graph of the `tables` in `image`, see lut_image, to `tree`. `recipe_of(closure id)` ->
    NodeRecipe. Returns the Graph.

    Each table gets all nodes: Cycles merges nodes that are equal. Removes all added nodes if it fails. Raises
    closure_graph.UnknownClosureError.
    """
    graph, shaders = Graph(tree), []
    try:
        for table in tables:
            shaders.append(closure_graph.draw(graph, table, image, recipe_of))
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
        total = mix_shader.between(graph, "without or with the film", coverage, shaders[1], total)
    output = graph.node("NodeGroupOutput", folded=False)
    output.is_active_output = True
    graph.link(total, output.inputs["Shader"])
    thin_sheet.draw(graph, lut, output)

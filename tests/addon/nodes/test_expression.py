# SPDX-License-Identifier: GPL-3.0-or-later
"""Formulas as nodes: which nodes they add, and where."""

import bpy
import pytest


@pytest.fixture
def graph(addon):
    from bl_ext.user_default.lamina.nodes.graph import Graph

    return Graph(bpy.data.node_groups.new("formulas", "ShaderNodeTree"))


@pytest.fixture
def formulas(addon):
    from bl_ext.user_default.lamina.nodes import expression

    return expression


def number(graph, kind="ShaderNodeValue"):
    return graph.value(graph.node(kind).outputs[0])


def steps(graph):
    """(operation, whether clamped) of the nodes of formulas, in the order in which they were added."""
    return [(node.operation, getattr(node, "use_clamp", False)) for node in graph.created if hasattr(node, "operation")]


def operand(value, index):
    socket = value.socket.node.inputs[index]
    return socket.links[0].from_socket if socket.is_linked else socket.default_value


def test_a_product_within_a_sum_is_one_node(graph):
    a, b, c = (number(graph) for _ in range(3))
    for formula in (a * b + c, c + a * b, a * 2.0 - 1.0, 1.0 - a * 2.0, a**2 + c):
        graph.created.clear()
        assert formula.socket and steps(graph) == [("MULTIPLY_ADD", False)]
    assert [operand(1.0 - a * 2.0, index) for index in (1, 2)] == [-2.0, 1.0]


def test_a_product_that_others_read_keeps_its_node(graph):
    a, b = number(graph), number(graph)
    named = (a * b).named("share")
    assert (named + 1.0).socket and steps(graph) == [("ADD", False), ("MULTIPLY", False)]
    assert [node.label for node in graph.created if node.label] == ["share"]
    graph.created.clear()
    read = a * b
    assert read.socket and (read + 1.0).socket and steps(graph) == [("MULTIPLY", False), ("ADD", False)]


def test_a_clamped_result_is_the_option_of_its_node(graph, formulas):
    a, b = number(graph), number(graph)
    total = a * b + 0.5
    assert formulas.clamped(total).socket and steps(graph) == [("MULTIPLY_ADD", True)]
    assert total.socket and steps(graph)[1:] == [("MULTIPLY_ADD", False)], "the formula itself is not clamped"
    assert formulas.clamped(a).socket and steps(graph)[2:] == [("ADD", True)]
    assert formulas.clamped(1.5) == 1.0


def test_vectors_and_numbers(graph, formulas):
    v, w, a = number(graph, "ShaderNodeCombineXYZ"), number(graph, "ShaderNodeCombineXYZ"), number(graph)
    expected = {"SCALE": v * a, "MULTIPLY": v * w, "ADD": v + (1.0, 2.0, 3.0), "SUBTRACT": 1.0 - v, "DIVIDE": v / w,
                "MULTIPLY_ADD": v * 0.5 + w}  # fmt: skip
    for operation, formula in expected.items():
        node = formula.socket.node
        assert formula.is_vector and (node.type, node.operation) == ("VECT_MATH", operation)
    assert tuple(operand(expected["SUBTRACT"], 0)) == (1.0, 1.0, 1.0)
    cosine = formulas.dot(v, w)
    assert not cosine.is_vector and cosine.socket.type == "VALUE" and (cosine < 0.5).socket.node.type == "MATH"
    graph.created.clear()
    assert (v / a).socket and steps(graph) == [("SCALE", False), ("DIVIDE", False)]


def test_nodes_stand_in_the_frame_of_their_formula(graph):
    a = number(graph)
    graph.begin_frame("first", (0.1, 0.1, 0.1))
    first = a / 3.0
    graph.begin_frame("second", (0.1, 0.1, 0.1))
    second = first - 1.0
    graph.end_frame()
    assert [value.socket.node.parent.label for value in (second, first)] == ["second", "first"]


def test_a_value_is_no_condition(graph):
    with pytest.raises(TypeError, match="known in the render only"):
        bool(number(graph) > 0.5)

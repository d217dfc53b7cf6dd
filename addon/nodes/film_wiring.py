# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts a pattern of film_pattern between the source of a film's coverage and the baked group."""

from ..base import renders
from . import detail_group, detail_wiring, rest_coordinates, thickness
from .detail_wiring import WANTED
from .film_pattern import NORMAL, PATTERNS, kind_of
from .group_sockets import COVERAGE

_INPUTS = (COVERAGE, NORMAL)


def node_of(material):
    """The node of the pattern of the material's film, or None."""
    nodes = () if material.node_tree is None else material.node_tree.nodes
    return next((one for one in nodes if kind_of(one) and one.get(thickness.MARK)), None)


def chosen(material):
    """The key of PATTERNS of the material's film, or ""."""
    node = node_of(material)
    return "" if node is None else kind_of(node)


def put(material, kind):
    """Let the film of `material` lie in this one of PATTERNS; returns the node. Its settings stay where the
    pattern is there already. Meshes with the material get rest coordinates. Raises RefusedError without a
    coverage input."""
    renders.stop_previews()
    thickness.required_sockets(material, COVERAGE)
    rest_coordinates.store_for(material)
    node = node_of(material)
    if node is not None and kind_of(node) == kind:
        PATTERNS[kind].group()  # drawn anew in files of earlier versions
        return node
    take(material)
    node = detail_wiring.new_node(material, "film", thickness.group_sockets(material, COVERAGE)[0].node)
    node.node_tree = PATTERNS[kind].group()
    node.width = 180.0
    detail_group.set_sizes(node, PATTERNS[kind].sizes)
    detail_wiring.insert(material, node, _INPUTS)
    return node


def take(material):
    """Link the source of the coverage to the baked group again, and remove the pattern."""
    renders.stop_previews()
    node = node_of(material)
    if node is None:
        return
    detail_wiring.take_out(material, node, _INPUTS)
    material.node_tree.nodes.remove(node)
    detail_group.remove_unused()


def follow(material):
    """After a bake: put the pattern that the material has as WANTED. A pattern tilts the surface only while
    there is a film."""
    if material.get(WANTED) in PATTERNS and thickness.has_input(material, COVERAGE):
        put(material, material.pop(WANTED))
    node = node_of(material)
    if node is None:
        return
    is_in = node.outputs[NORMAL].is_linked
    if not thickness.has_input(material, COVERAGE):
        detail_wiring.take_out(material, node, (NORMAL,))
    elif not is_in:
        detail_wiring.insert(material, node, _INPUTS)

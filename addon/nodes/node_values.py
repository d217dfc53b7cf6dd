# SPDX-License-Identifier: GPL-3.0-or-later
"""What the output of nodes depends on, as a short text: for results that were computed from the nodes."""

import hashlib

import bpy

from . import links


def mark(node, skipped=()):
    """A text that changes when `node` or a node that feeds it is set, linked or replaced otherwise; cheap.
    Names and places of nodes do not matter, nor do values of the input sockets `skipped`."""
    found = sorted(repr(_of_node(one, skipped)) for one in links.upstream(node))
    return hashlib.sha256(repr(found).encode()).hexdigest()[:16]


def _of_node(node, skipped=()):
    common = bpy.types.Node.bl_rna.properties.keys()
    found = [node.bl_idname, node.mute]
    for one in node.bl_rna.properties:
        if one.identifier not in common and not getattr(one, "is_deprecated", False):
            found.append(_plain(getattr(node, one.identifier)))
    for socket in node.inputs:
        if socket.is_linked:
            found.append([(link.from_node.bl_idname, link.from_socket.identifier, link.is_muted)
                          for link in socket.links])
        elif hasattr(socket, "default_value") and socket not in skipped:
            found.append(_plain(socket.default_value))
    return found


def _plain(value):
    """A value of a property as numbers and texts."""
    if isinstance(value, bpy.types.NodeTree):
        return [value.name, sorted(repr(_of_node(one)) for one in value.nodes)]
    if isinstance(value, bpy.types.ID):
        return [value.name, getattr(value, "filepath", "")]
    if isinstance(value, bpy.types.ColorRamp):
        return [value.color_mode, value.interpolation, [(one.position, *one.color) for one in value.elements]]
    if isinstance(value, bpy.types.CurveMapping):
        return [[(*point.location, point.handle_type) for point in curve.points] for curve in value.curves]
    if isinstance(value, str) or not hasattr(value, "__len__"):
        return None if isinstance(value, bpy.types.bpy_struct) else value
    return [] if isinstance(value, bpy.types.bpy_prop_collection) else list(value)

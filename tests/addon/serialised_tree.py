# SPDX-License-Identifier: GPL-3.0-or-later
"""A material and its node tree as plain data: each node, value, link and animation. Shares no code with the add-on."""

import bpy

# What Blender computes or counts itself, and the selection.
SKIPPED = {"rna_type", "select", "dimensions", "internal_links", "inputs", "outputs", "links", "nodes", "users",
           "session_uid", "is_updated", "is_updated_data", "id_data", "tag", "preview", "show_preview",
           "is_evaluated", "location_absolute", "original", "lamina", "asset_data", "warning_propagation"}


def of_material(material):
    """Everything of a material that the add-on could change, without its own settings."""
    settings = _properties(material, skip={"node_tree", "cycles"})
    cycles = _properties(material.cycles) if hasattr(material, "cycles") else None
    return {"settings": settings, "cycles": cycles, "tree": of_tree(material.node_tree)}


def of_file():
    """The names of all data that materials use."""
    return {name: sorted(one.name for one in getattr(bpy.data, name)) for name in ("images", "node_groups", "actions")}


def of_tree(tree):
    if tree is None:
        return None
    output = tree.get_output_node("CYCLES") if tree.bl_idname == "ShaderNodeTree" else None
    return {
        "nodes": {node.name: _node(node) for node in tree.nodes},
        "links": sorted(_link(link) for link in tree.links),
        "output": output.name if output else None,
        "active": tree.nodes.active.name if tree.nodes.active else None,
        "own": _own(tree),
        "animation": _animation(tree.animation_data),
    }


def _node(node):
    return {
        "properties": _properties(node),
        "absolute": tuple(getattr(node, "location_absolute", ())),
        "own": _own(node),
        "inputs": [_socket(socket) for socket in node.inputs],
        "outputs": [_socket(socket) for socket in node.outputs],
        "inside": of_tree(node.node_tree) if node.type == "GROUP" else None,
    }


def _link(link):
    ends = (link.from_node.name, link.from_socket.identifier, link.to_node.name, link.to_socket.identifier)
    return (*ends, link.is_muted)


def _socket(socket):
    value = _plain(getattr(socket, "default_value", None))
    return socket.identifier, socket.type, value, socket.hide, socket.enabled, socket.is_linked


def _properties(owner, skip=frozenset(), depth=0):
    found = {}
    for prop in owner.bl_rna.properties:
        name = prop.identifier
        if name in SKIPPED or name in skip or name.startswith("bl_") or getattr(prop, "is_deprecated", False):
            continue
        value = getattr(owner, name)
        if prop.type == "POINTER" and value is not None and not isinstance(value, bpy.types.ID | bpy.types.Node):
            found[name] = _properties(value, depth=depth + 1) if depth < 3 else None
        elif prop.type == "COLLECTION":
            found[name] = [_properties(item, depth=depth + 1) for item in value] if depth < 3 else None
        else:
            found[name] = _plain(value)
    return found


def _own(owner):
    """Custom properties."""
    return {key: _plain(owner[key]) for key in owner.keys()}  # noqa: SIM118 (Blender's data is no dict)


def _plain(value):
    if hasattr(value, "to_dict"):
        return {key: _plain(item) for key, item in value.items()}
    if hasattr(value, "name"):
        return type(value).__name__, value.name
    if isinstance(value, str | bytes | int | float | bool) or value is None:
        return value
    return [_plain(item) for item in value]


def _animation(animation):
    """F-curves and drivers. Animation data without content counts as none."""
    if animation is None:
        return None
    curves = []
    if animation.action is not None:
        for curve in _curves(animation):
            points = [(tuple(p.co), tuple(p.handle_left), tuple(p.handle_right), p.interpolation)
                      for p in curve.keyframe_points]
            curves.append((curve.data_path, curve.array_index, points))
    drivers = [
        (one.data_path, one.array_index, one.driver.type, one.driver.expression,
         [(v.name, v.type, [_target(target) for target in v.targets]) for v in one.driver.variables])
        for one in animation.drivers
    ]
    return {"curves": sorted(curves), "drivers": sorted(drivers)} if curves or drivers else None


def _target(target):
    return target.id.name if target.id else None, target.data_path


def _curves(animation):
    if bpy.app.version < (4, 4, 0):
        return animation.action.fcurves
    from bpy_extras import anim_utils

    bag = anim_utils.action_get_channelbag_for_slot(animation.action, animation.action_slot)
    return bag.fcurves if bag else ()

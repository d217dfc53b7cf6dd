# SPDX-License-Identifier: GPL-3.0-or-later
"""UV maps by name; an empty name means the map that is active for rendering."""


def find(mesh, name):
    """The UV map `name` of a mesh, or None."""
    if name:
        return mesh.uv_layers.get(name)
    return next((one for one in mesh.uv_layers if one.active_render), None)


def has_none(context):
    """True if the active object is a mesh without a UV map, of its own or of its modifiers."""
    thing = context.object
    if thing is None or thing.type != "MESH":
        return False
    return not thing.evaluated_get(context.evaluated_depsgraph_get()).data.uv_layers


def missing(thing, name):
    """The sentence for an object without the UV map `name`, for a panel or an error."""
    wanted = f" named “{name}”" if name else ""
    return f"{thing.name} has no UV map{wanted}"


def choice(thing, mesh, name):
    """(sentence, True if it is a fault) on the UV map that the object `thing` with this mesh uses. The
    sentence is "" for a map that is named and exists."""
    found = find(mesh, name)
    if found is None:
        return f"{missing(thing, name)}: unwrap it" + (", or choose another map" if name else ""), True
    if name:
        return "", False
    return f"The field is empty: the map “{found.name}” is used, which is active for rendering", False

# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the last result of an interior still fits its object, settings and lamps.

A note of what the result was computed from is kept in the material. It holds only what is cheap to read,
since the panel compares it whenever it is drawn. Matrices of objects that the viewport does not show are not
up to date, so those objects are compared by their own location, rotation and scale.
"""

import json

import numpy as np

from ..base import linking
from ..base.messages import RefusedError
from ..editing import layer_list
from ..kinds import interiors
from ..nodes import node_values, other_materials
from . import around, body, lamps, lights, seen

STILL = 1e-3  # relative, and in radians: what changed by less counts as unchanged
SOME = 128  # vertices whose places are compared
AGAIN = "compute again"

_OWN = body.Frame(np.eye(3), np.zeros(3), np.ones(3), 1.0)  # for a lamp's own location, rotation and scale


def note(context, obj, material, node, uv_map, has_image):
    """The note as JSON. `node`: (node, output) of the texture that is used, or (). `uv_map`: the one that is
    used. `has_image`: the world lights by an image."""
    context.evaluated_depsgraph_get()  # brings matrices and boxes up to date
    found = {
        "settings": _settings(material, node),
        "map": uv_map if uv_map in obj.data.uv_layers else "",  # "": a modifier makes it
        "body": _body(obj, context.scene),
        "faces": other_materials.counts(obj, material),
    }
    settings = material.lamina.interior
    if settings.output == "LIT":
        frame = _frame(obj, context.scene)
        found["lamps"], found["place"] = _lamps(context, obj, frame), _place(frame)
        shown = list(seen.objects(context.view_layer.layer_collection))
        found["around"] = around.mark(shown, obj)
        found["looks"], found["shines"] = around.looks(shown, obj)
        found["sky"] = lights.mark(context.scene, found["shines"])
        found["turns"] = has_image
        found["camera"] = _camera(context.scene, frame) if settings.view == "CAMERA" else None
    return json.dumps(found)


def stale(context, obj, material):
    """The reason why the last result no longer fits, in a sentence, or ''."""
    settings = material.lamina.interior
    if not settings.made_from or obj is None or obj.type != "MESH":
        return ""
    earlier = json.loads(settings.made_from)
    now = _settings(material, (settings.node, settings.socket))
    if _differ({**now, "layers": ""}, {**earlier["settings"], "layers": ""}):
        return f"The settings have changed since: {AGAIN}"
    if now["layers"] != earlier["settings"]["layers"]:
        return f"The layers have changed since: {AGAIN}"
    if earlier["map"] and earlier["map"] not in obj.data.uv_layers:
        return f"The UV map “{earlier['map']}” is gone: {AGAIN}"
    try:
        if not _alike_bodies(_body(obj, context.scene), earlier["body"]):
            return f"The object has been scaled or edited since: {AGAIN}"
        faces = other_materials.counts(obj, material)
        if earlier.get("faces", faces) != faces:
            return f"The materials of the object's faces have changed since: {AGAIN}"
        return _stale_light(context, obj, earlier) if "lamps" in earlier else ""
    except RefusedError as error:
        return str(error)


def _stale_light(context, obj, earlier):
    frame = _frame(obj, context.scene)
    now, place = _under_earlier_names(_lamps(context, obj, frame), earlier["lamps"]), _place(frame)
    gone = [name for name in earlier["lamps"] if name not in now]
    if gone:
        return f"{_listed(gone)} no longer lights the object: {AGAIN}"
    new = [name for name in now if name not in earlier["lamps"]]
    if new:
        return f"{_listed(new)} lights the object now: {AGAIN}"
    linked = [name for name, one in now.items() if one["linking"] != earlier["lamps"][name].get("linking")]
    if linked:
        return f"{_listed(linked)} has another light linking or shadow linking since: {AGAIN}"
    moved = [name for name, one in now.items() if not _alike_lamps(one, earlier["lamps"][name])]
    has_place = place is not None and earlier["place"] is not None
    if moved and has_place and not _alike(place, earlier["place"]):
        return f"The object has moved against its lamps since: {AGAIN}"
    if moved:
        return f"{_listed(moved)} has moved or changed in size since: {AGAIN}"
    if earlier["turns"] and has_place and not _alike({"axes": place["axes"]}, earlier["place"]):
        return f"The object has turned under the world's image since: {AGAIN}"
    others = earlier.get("around")
    shown = list(seen.objects(context.view_layer.layer_collection))
    # Earlier versions counted names as well.
    if others and all(around.mark(shown, obj, with_names) != others for with_names in (False, True)):
        return f"Other objects have moved or changed since: {AGAIN}"
    if "looks" in earlier and around.looks(shown, obj)[0] != earlier["looks"]:
        return f"Materials of other objects have changed in color or light since: {AGAIN}"
    if "sky" in earlier and lights.mark(context.scene, earlier["shines"]) != earlier["sky"]:
        return f"The world has changed since: {AGAIN}"
    camera = _camera(context.scene, frame)
    if earlier["camera"] and camera is not None and not _alike(camera, earlier["camera"]):
        return f"The camera has moved against the object since: {AGAIN}"
    return ""


def _under_earlier_names(now, earlier):
    """The notes of lamps, where one that only the name tells from an earlier one has the earlier name."""
    found = dict(now)
    for name, one in earlier.items():
        alike = (new for new in now if new not in earlier and new in found and _same_lamps(now[new], one))
        new = next(alike, None) if name not in now else None
        if new is not None:
            found[name] = found.pop(new)
    return found


def _same_lamps(one, other):
    return one["linking"] == other.get("linking") and _alike_lamps(one, other)


def _listed(names):
    """The names as a part of a sentence; beyond three, their number."""
    return " and ".join(names) if len(names) <= 3 else f"{names[0]}, with {len(names) - 1} other lamps,"


def _settings(material, node):
    """What the panel sets and the result depends on; not the noise."""
    settings = material.lamina.interior
    fields = {"source": settings.source, "output": settings.output, "map": settings.map,
              "uv_map": settings.uv_map, "size": settings.size, "layers": "",
              "view": settings.view if settings.output == "LIT" else ""}  # fmt: skip
    if settings.source == "LAYERS":
        return fields | {"layers": layer_list.mark(material)}
    fields |= _values(settings, interiors.BODY)
    fields["ends"] = [_values(end, interiors.GROUND) for end in (settings.first, settings.second)]
    if settings.source == "NODES":
        texture = material.node_tree.nodes.get(node[0]) if node and material.node_tree is not None else None
        return fields | {"node": list(node), "texture": "" if texture is None else node_values.mark(texture)}
    return fields | _values(settings, interiors.MARBLE) | {"direction": list(settings.direction)}


def _differ(now, earlier):
    """True if settings differ. Those that only one of the two has, from another version of Lamina, do not
    count."""
    if isinstance(now, dict) and isinstance(earlier, dict):
        return any(_differ(now[name], earlier[name]) for name in now.keys() & earlier.keys())
    if isinstance(now, list) and isinstance(earlier, list) and len(now) == len(earlier):
        return any(map(_differ, now, earlier))
    return now != earlier


def _values(owner, fields):
    """{property: value} of the fields that the panel shows."""
    return {field.prop: _plain(getattr(owner, field.prop)) for field in fields if field.panel is not None}


def _plain(value):
    return list(value) if hasattr(value, "__len__") else value


def _frame(obj, scene):
    """The Frame of an object that the viewport shows, otherwise None. Raises RefusedError."""
    return body.frame_of(obj, scene) if obj.visible_get() else None


def _place(frame):
    if frame is None:
        return None
    return {"axes": frame.axes.ravel().tolist(), "origin": (frame.unit * frame.origin).tolist()}


def _body(obj, scene):
    """Its size, the numbers of vertices and faces, and the places of some of the vertices."""
    frame = _frame(obj, scene)
    box = None if frame is None else frame.scale * frame.unit * np.array(obj.bound_box)
    return {
        "box": None if box is None else box.ravel().tolist(),
        "scale": [*obj.scale, scene.unit_settings.scale_length],
        "counts": [len(obj.data.vertices), len(obj.data.polygons)],
        "vertices": _places_of_some(obj.data.vertices),
    }


def _places_of_some(vertices):
    """Of `SOME` vertices or fewer, evenly among all: a dent moves some of them."""
    chosen = np.linspace(0, len(vertices) - 1, min(SOME, len(vertices))).astype(int).tolist()
    return [float(f"{value:.7g}") for number in chosen for value in vertices[number].co]


def _alike_bodies(one, other):
    if one["counts"] != other["counts"]:
        return False
    if "vertices" in other and not _alike_places(one["vertices"], other["vertices"]):
        return False
    if one["box"] is None or other["box"] is None:
        return bool(np.allclose(one["scale"], other["scale"], rtol=STILL))
    return _alike_places(one["box"], other["box"])


def _alike_places(one, other):
    """True if no point of a list has moved by more than a share of their extent."""
    size = max(np.ptp(np.reshape(other, (-1, 3)), axis=0))
    return bool(np.abs(np.subtract(one, other)).max() <= STILL * size)


def _lamps(context, obj, frame):
    """{name: note} of the lamps that light the object in renders."""
    found = {}
    for other in seen.objects(context.view_layer.layer_collection):
        where = other.visible_get() and frame
        if other.type == "LIGHT" and lamps.shines(other, obj):
            found[other.name] = _lamp(other, other.matrix_world, other.matrix_basis, where)
        elif other.instance_type == "COLLECTION" and other.instance_collection is not None:
            for one in other.instance_collection.all_objects:
                if one.type == "LIGHT" and not one.hide_render and lamps.shines(one, obj):
                    matrices = other.matrix_world @ one.matrix_basis, other.matrix_basis @ one.matrix_basis
                    found[f"{one.name} of {other.name}"] = _lamp(one, *matrices, where)
    return found


def _lamp(obj, matrix, basis, frame):
    """`frame`: in which the lamp's matrix counts; None or False: its matrix is not up to date."""
    linked = linking.of(obj)
    return {
        "kind": obj.data.type,
        "linking": None if linked == linking.ALL else linked.note(),
        "normalize": getattr(obj.data, "normalize", True),
        "seen": lamps.numbers(obj, np.array(matrix, float), frame) if frame else None,
        "own": lamps.numbers(obj, np.array(basis, float), _OWN),
    }


def _alike_lamps(one, other):
    if (one["kind"], one["normalize"]) != (other["kind"], other["normalize"]):
        return False
    which = "seen" if one["seen"] and other["seen"] else "own"
    return _alike(one[which], other[which])


def _camera(scene, frame):
    """The place of the scene's camera; None if the viewport does not show the camera or the object."""
    camera = scene.camera
    return frame.view(camera) if frame and camera is not None and camera.visible_get() else None


def _alike(one, other):
    """`other` may have further numbers."""
    for name, value in one.items():
        if name not in other:
            return False
        mine, theirs = np.atleast_1d(value).astype(float), np.atleast_1d(other[name]).astype(float)
        size = max(1.0, float(np.abs(theirs).max()))
        if np.abs(mine - theirs).max() > STILL * size:
            return False
    return True

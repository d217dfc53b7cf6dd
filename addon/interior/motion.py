# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves in the animation: images of an interior fit one shape, and light maps hold one frame's light."""

from ..base import f_curves
from . import lamps, seen

# How the data paths of motion begin; eval_time is that of a curve that objects follow.
PLACES = ("location", "rotation", "scale", "delta_", "pose.bones", "constraints", "eval_time")
# Modifiers that change the shape in time by themselves; others do so if their object moves.
SIMULATIONS = {"CLOTH", "SOFT_BODY", "OCEAN", "WAVE", "MESH_CACHE", "MESH_SEQUENCE_CACHE", "FLUID", "EXPLODE"}
FOLLOWING = {"ARMATURE", "LATTICE", "HOOK", "CURVE", "MESH_DEFORM", "CAST", "SIMPLE_DEFORM"}


def sentence(context, obj, settings):
    """What images with these settings do not follow, and the remedy; or ''."""
    if deforms(obj):
        remedy = ": choose Soft" if settings.source == "LAYERS" else ""
        return f"{obj.name} deforms in the animation, but images fit one shape{remedy}"
    if settings.output != "LIT":
        return ""
    if moving := moving_lamps(context, obj):
        return f"{moving[0]} moves against {obj.name} in the animation: choose Lamps May Move"
    camera = context.scene.camera
    if settings.view == "CAMERA" and camera is not None and _movers(camera) != _movers(obj):
        return "The camera moves in the animation: choose the view All"
    return ""


def moving_lamps(context, obj):
    """Names of the lamps that light the object and move against it."""
    own, shown = _movers(obj), seen.objects(context.view_layer.layer_collection)
    return [one.name for one, moved in _lamps(shown) if moved != own and lamps.shines(one, obj)]


def _lamps(objects, carried=frozenset()):
    """Pairs of a lamp among `objects`, or in a collection that one of them shows, and what moves it: its own
    movers, and those of the objects that carry it (`carried`)."""
    for one in objects:
        moved = carried | _movers(one)
        if one.type == "LIGHT":
            yield one, moved
        elif one.instance_type == "COLLECTION" and one.instance_collection is not None:
            inside = one.instance_collection.all_objects
            yield from _lamps([each for each in inside if not each.hide_render], moved)


def deforms(obj):
    """True if the mesh of the object changes its shape in the animation."""
    keys = obj.data.shape_keys
    return (keys is not None and bool(_paths(keys))
            or any(path.startswith("modifiers") for path in _paths(obj))
            or any(_deforms(one) for one in obj.modifiers if one.show_render))


def _deforms(modifier):
    if modifier.type in SIMULATIONS:
        return True
    return modifier.type in FOLLOWING and bool(_movers(getattr(modifier, "object", None)))


def _movers(obj):
    """{(object, whether through a constraint)} whose animation moves `obj`: itself, its parents, and what
    constraints follow."""
    found, known, left = set(), set(), [(obj, False)]
    while left:
        one, follows = left.pop()
        if one is None or (one, follows) in known:
            continue
        known.add((one, follows))
        paths = [*_paths(one), *(_paths(one.data) if one.type == "CURVE" else ())]
        if any(path.startswith(PLACES) for path in paths):
            found.add((one, follows))
        left.append((one.parent, follows))
        left += [(getattr(each, "target", None), True) for each in one.constraints if not each.mute]
    return found


def _paths(block):
    """The data paths that F-curves and drivers of a data-block set."""
    animation = block.animation_data
    if animation is None:
        return []
    return [one.data_path for curves in (*f_curves.of_all(animation), animation.drivers) for one in curves]

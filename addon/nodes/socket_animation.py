# SPDX-License-Identifier: GPL-3.0-or-later
"""The animation of a node socket's value: F-curves and drivers, and their copies for another socket."""

import bpy

VALUE = "default_value"

# Properties of a key of an F-curve. Types of handles come before the handles, which depend on them.
_KEY = ("co", "interpolation", "easing", "back", "amplitude", "period", "type", "handle_left_type",
        "handle_right_type", "handle_left", "handle_right")


def is_animated(socket):
    """True if F-curves or drivers set the value of `socket`."""
    animation = socket.id_data.animation_data
    return animation is not None and bool(_of(_curves(animation), socket) or _of(animation.drivers, socket))


def copy(given, target):
    """Animate the value of the socket `target`, of the same tree, as that of the socket `given`.

    Blender removes the copies together with the node of `target`."""
    animation = given.id_data.animation_data
    if animation is None:
        return
    path = target.path_from_id(VALUE)
    curves = _curves(animation)
    for curve in _of(curves, given):
        _copy_curve(curve, curves.new(path, index=curve.array_index))
    for driver in _of(animation.drivers, given):
        new = animation.drivers.from_existing(src_driver=driver)
        new.data_path, new.array_index = path, driver.array_index


def _of(curves, socket):
    path = socket.path_from_id(VALUE)
    return [curve for curve in curves if curve.data_path == path]


def _curves(animation):
    """The F-curves of the active action."""
    action = animation.action
    if action is None:
        return ()
    if bpy.app.version < (4, 4, 0):
        return action.fcurves
    # From Blender 4.4 on, each user of an action has a slot with curves of its own.
    bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags
            if bag.slot_handle == animation.action_slot_handle]
    return bags[0].fcurves if bags else ()


def _copy_curve(curve, new):
    new.extrapolation, new.mute = curve.extrapolation, curve.mute
    new.keyframe_points.add(len(curve.keyframe_points))
    for key, copied in zip(curve.keyframe_points, new.keyframe_points, strict=True):
        for name in _KEY:
            setattr(copied, name, getattr(key, name))
    for modifier in curve.modifiers:
        copied = new.modifiers.new(modifier.type)
        for prop in modifier.bl_rna.properties:
            if not prop.is_readonly and prop.type not in ("POINTER", "COLLECTION"):
                setattr(copied, prop.identifier, getattr(modifier, prop.identifier))
    new.update()

# SPDX-License-Identifier: GPL-3.0-or-later
"""The animation of a node socket's value: F-curves and drivers, and their copies for another socket."""

from contextlib import contextmanager

from ..base import f_curves

VALUE = "default_value"

# Properties of a key of an F-curve. Types of handles come before the handles, which depend on them.
_KEY = ("co", "interpolation", "easing", "back", "amplitude", "period", "type", "handle_left_type",
        "handle_right_type", "handle_left", "handle_right")


def is_animated(socket):
    """True if F-curves, also those in strips, or drivers set the value of `socket`."""
    animation = socket.id_data.animation_data
    if animation is None:
        return False
    return any(_of(curves, socket) for curves in (*f_curves.of_all(animation), animation.drivers))


def copy(given, target):
    """Animate the value of the socket `target`, of the same tree, as that of the socket `given`.

    Blender removes the copies together with the node of `target`."""
    animation = given.id_data.animation_data
    if animation is None:
        return
    path = target.path_from_id(VALUE)
    for curves in f_curves.of_all(animation):
        for curve in _of(curves, given):
            _copy_curve(curve, curves.new(path, index=curve.array_index))
    for driver in _of(animation.drivers, given):
        new = animation.drivers.from_existing(src_driver=driver)
        new.data_path, new.array_index = path, driver.array_index


def remove(socket):
    """Remove the animation of the value of `socket`."""
    if hasattr(socket, VALUE):
        _move(socket.node, {socket.path_from_id(VALUE): None})


@contextmanager
def held(nodes):
    """While inputs of `nodes` are removed: animation stays with its input, that of removed inputs goes.

    Blender's data paths have the number of an input, so that the animation would go on with another one.
    Some versions of Blender adapt some of the paths (5.2 does). So the paths have no numbers meanwhile."""
    marks = []
    for node in nodes:
        for socket in node.inputs:
            if hasattr(socket, VALUE):
                mark = f"lamina {node.name} {socket.identifier}"
                marks.append((node, socket.identifier, mark))
                _move(node, {socket.path_from_id(VALUE): mark})
    yield
    for node, identifier, mark in marks:
        socket = next((one for one in node.inputs if one.identifier == identifier), None)
        _move(node, {mark: None if socket is None else socket.path_from_id(VALUE)})


def _move(node, paths):
    """Change data paths of animation of the node's tree, {earlier: new}; None removes the animation."""
    animation = node.id_data.animation_data
    if animation is None:
        return
    for curves in (*f_curves.of_all(animation), animation.drivers):
        for curve in [one for one in curves if one.data_path in paths]:
            path = paths[curve.data_path]
            if path is None:
                curves.remove(curve)
            else:
                curve.data_path = path


def _of(curves, socket):
    path = socket.path_from_id(VALUE)
    return [curve for curve in curves if curve.data_path == path]


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

# SPDX-License-Identifier: GPL-3.0-or-later
"""An object, its lamps and the camera, as renders see the scene."""

from dataclasses import dataclass

from ..base import native, rendered
from ..base.messages import RefusedError
from . import around, body, lamps


@dataclass(frozen=True)
class Seen:
    """`body`: a body.Body. `lamps`: a list of lights.Source. `view`: of the camera, see Frame.view, or {}.
    `occluders`: a lamina.Occluders of the other objects, or None."""

    body: body.Body
    lamps: list
    view: dict
    occluders: object


def of_object(context, obj, material, uv_map=None, lit=True, camera=False):
    """What renders see. An object that is hidden in renders is read as the viewport shows it. `uv_map`: see
    body.of_object; `lit`: with lamps and other objects; `camera`: with the view of the scene's camera. Raises
    RefusedError."""
    scene, lamina = context.scene, native.require()
    if camera and scene.camera is None:
        raise RefusedError("The scene has no camera: set one, or choose the view All")

    def light(depsgraph, frame):
        if not lit:
            return [], {}, None
        view = frame.view(depsgraph.scene_eval.camera) if camera else {}
        found = lamps.rendered(depsgraph, frame, obj)
        others, found = around.occluders(depsgraph, obj, frame, lamina, found)
        return found, view, others

    def read(depsgraph):
        shape = body.of_object(depsgraph, obj, material, uv_map)
        return None if shape is None else Seen(shape, *light(depsgraph, shape.frame))

    found = rendered.visit(scene, context.view_layer, read)
    if found is not None:
        return found
    shape = body.of_object(context.evaluated_depsgraph_get(), obj, material, uv_map)
    if shape is None:
        raise body.hidden(obj)
    if not lit:
        return Seen(shape, [], {}, None)
    return Seen(shape, *rendered.visit(scene, context.view_layer, lambda graph: light(graph, shape.frame)))


def objects(layer):
    """The objects of a layer collection that renders see, with instances of collections; those in several
    collections more than once."""
    if layer.collection.hide_render:
        return
    if not layer.exclude:
        yield from (one for one in layer.collection.objects if not one.hide_render)
    for child in layer.children:
        yield from objects(child)

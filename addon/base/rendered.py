# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as it is rendered: modifiers at the level of renders, instances of collections, and without what
is hidden in renders.

Blender gives such a dependency graph to render engines only. So a tiny engine is registered for one render,
which reads the graph and draws nothing.
"""

from contextlib import contextmanager

import bpy

from . import renders
from .messages import RefusedError

SHAPES = frozenset({"MESH", "CURVE", "SURFACE", "META", "FONT"})  # types of objects with faces
_ENGINE = "LAMINA_reader"
# Settings of a render that would do more than the engine: write files, draw strips or lines, render once for
# each eye, or keep the engine's data after the engine is gone.
_OFF = ("use_compositing", "use_sequencer", "use_freestyle", "use_multiview", "use_persistent_data")


def shown(view_layer):
    """The objects that renders of a view layer show: neither they nor their collections are off in renders,
    or excluded."""
    found, waiting = set(), [view_layer.layer_collection]
    while waiting:
        one = waiting.pop()
        if not one.collection.hide_render:
            waiting += one.children
            found.update(() if one.exclude else one.collection.objects)
    return [obj for obj in view_layer.objects if obj in found and not obj.hide_render]


def can_convert(obj):
    """True for a curve, a text, a surface or metaballs, which Blender converts to a mesh."""
    return obj is not None and obj.type in SHAPES and obj.type != "MESH"


def to_convert(obj):
    """The sentence that refuses an object of another type than a mesh."""
    return f"{obj.name} is no mesh: convert it (Object > Convert > Mesh)"


def viewport(context):
    """The dependency graph of the viewport, up to date.

    Below an overridden context, context.evaluated_depsgraph_get reads Python's dictionary of overrides
    without Python's lock if another thread holds that lock, and Blender crashes (seen in 4.5)."""
    context.view_layer.update()
    return context.view_layer.depsgraph


def visit(scene, view_layer, read):
    """Returns read(depsgraph) for the dependency graph of a render of `view_layer`. Main thread only.

    The graph and its data end with the call: `read` returns copies, and must not render. Exceptions of `read`
    are raised. All settings of the scene are as before afterwards. Raises RefusedError during a render,
    and in Blender before 5.2 during that of a preview."""
    if renders.is_scene_rendering():
        raise RefusedError("Blender is rendering: wait until the render ends, or stop it")
    renders.end_previews()
    found, errors = [], []

    class Reader(bpy.types.RenderEngine):
        bl_idname, bl_label, bl_use_preview = _ENGINE, "Lamina", False

        def render(self, depsgraph):
            if found or errors:
                return
            # An exception would end in Blender's console.
            try:
                found.append(read(depsgraph))
            except BaseException as error:
                errors.append(error)

    bpy.utils.register_class(Reader)
    try:
        with _changed(scene, view_layer), _camera(scene), renders.own_render():
            bpy.ops.render.render(scene=scene.name, layer=view_layer.name)
    finally:
        bpy.utils.unregister_class(Reader)
    if errors:
        raise errors[0]
    if not found:
        raise RuntimeError(f"Blender did not render the view layer {view_layer.name}")
    return found[0]


def is_itself(instance, obj):
    """True if an instance of a dependency graph is the object, and no copy of it by an instancer."""
    return not instance.is_instance and instance.object.original == obj


def casts_shadow(instance):
    """True if an instance of a dependency graph has faces that renders show to shadow rays."""
    other = instance.object
    if other.type not in SHAPES or other.original.hide_render or not other.original.visible_shadow:
        return False
    return instance.is_instance or instance.show_self


@contextmanager
def _changed(scene, view_layer):
    """The scene's settings for a render of this view layer by the reader alone."""
    render = scene.render
    before = {name: getattr(render, name) for name in _OFF}
    engine, use = render.engine, view_layer.use
    try:
        for name, value in before.items():
            if value:
                setattr(render, name, False)
        render.engine, view_layer.use = _ENGINE, True
        yield
    finally:
        render.engine, view_layer.use = engine, use
        for name, value in before.items():
            if value:
                setattr(render, name, True)


@contextmanager
def _camera(scene):
    """A camera for a scene without one: Blender renders no scene without a camera."""
    if scene.camera is not None:
        yield
        return
    data = bpy.data.cameras.new("lamina reader")
    eye = bpy.data.objects.new("lamina reader", data)
    try:
        scene.camera = eye
        yield
    finally:
        scene.camera = None
        bpy.data.objects.remove(eye)
        bpy.data.cameras.remove(data)

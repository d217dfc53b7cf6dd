# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers that several add-on tests share."""

import time

import bmesh
import bpy
import numpy as np


def image_of(group):
    """The one image that the group's texture nodes share."""
    images = {node.image for node in group.nodes if node.type == "TEX_IMAGE"}
    assert len(images) == 1
    return images.pop()


def pixels(image):
    """float32 (height, width, 4), bottom row first."""
    values = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def built_mesh(name, build, smooth=False):
    """A mesh that build(bm) makes by bmesh."""
    mesh, bm = bpy.data.meshes.new(name), bmesh.new()
    build(bm)
    for face in bm.faces:
        face.smooth = smooth
    bm.normal_update()
    bm.to_mesh(mesh)
    bm.free()
    return mesh


def icosphere(name, radius, smooth=False):
    """The mesh of a ball of 80 triangles."""
    return built_mesh(name, lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=2, radius=radius), smooth)


def linked(name, data=None, collection=None):
    """A new object in a collection, by default that of the scene."""
    made = bpy.data.objects.new(name, data)
    (collection or bpy.context.scene.collection).objects.link(made)
    return made


def surface_source(material):
    """The node that feeds the Surface of the material's output."""
    return material.node_tree.get_output_node("CYCLES").inputs["Surface"].links[0].from_node


def snapshot(material):
    """All that a bake could change in the material's group."""
    group = material.lamina.node_group
    return sorted(node.name for node in group.nodes), pixels(image_of(group)).tobytes()


def look_until_rest(update, seconds=60.0):
    """The return values of the timer's function of updates, called until nothing is left to do."""
    seen, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        seen.append(update.poll())
        if seen[-1] is None:
            return seen
        time.sleep(seen[-1])
    raise AssertionError("the updates do not come to rest")


class Layout:
    """Records what a panel draws, and raises an error for unknown properties and icons."""

    def __init__(self):
        self.__dict__.update(lines=[], operator_context="INVOKE_DEFAULT")

    def __setattr__(self, name, value):
        self.__dict__[name] = value

    def _inside(self, *_args, **_options):
        inside = Layout()
        inside.__dict__["lines"] = self.lines
        return inside

    row = column = split = box = grid_flow = _inside

    def panel(self, _name, default_closed=False):
        return self._inside(), self._inside()

    def prop(self, owner, name, text=None, **_options):
        assert name in owner.bl_rna.properties, name
        self.lines.append(owner.bl_rna.properties[name].name if text is None else text)

    def prop_enum(self, owner, name, value, text=None, **_options):
        item = owner.bl_rna.properties[name].enum_items[value]
        self.lines.append(item.name if text is None else text)

    def progress(self, factor, text):
        assert 0.0 <= factor <= 1.0
        self.lines.append(text)

    def template_ID(self, owner, name, **_options):  # noqa: N802 (Blender's name)
        self.prop(owner, name)

    def template_list(self, cls, _name, *_what, **_options):
        assert hasattr(bpy.types, cls)

    def operator_menu_enum(self, name, _property, text=None, **options):
        self.operator(name, text, **options)

    def template_icon_view(self, owner, name, **_options):
        self.prop(owner, name)

    def template_icon(self, icon_value, scale=1.0):
        assert isinstance(icon_value, int) and scale > 0.0
        self.lines.append("(picture)")

    def prop_search(self, owner, name, container, items, text=None, **_options):
        assert items in container.bl_rna.properties, items
        self.prop(owner, name, text)

    def label(self, text="", icon="NONE"):
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        self.lines.append(text)

    def operator(self, name, text=None, icon="NONE", **_options):
        module, function = name.split(".")
        kind = getattr(getattr(bpy.ops, module), function).get_rna_type()  # fails without such an operator
        self.lines.append(kind.name if text is None else text)
        return type("Properties", (), {})()

    def menu(self, name, text=None, **_options):
        self.lines.append(getattr(bpy.types, name).bl_label if text is None else text)

    def separator(self, **_options):
        pass


def drawn(function, *arguments):
    """The texts that function(layout, *arguments) draws."""
    layout = Layout()
    function(layout, *arguments)
    return layout.lines


def detached(addon, operator):
    """An operator without Blender's own part, which exists only in a window; `reports` holds its reports."""
    own = {name: getattr(operator, name) for name in ("jobs", "kept", "told", "failed")}
    made = type("Operator", (addon.operators.following.Following,), own)()
    made.reports = []
    made.report = lambda level, text: made.reports.append((*level, text))
    return made


def sun(name, towards, energy=2.0):
    """A new sun of the scene, .1 radians wide, turned by the Euler angles `towards`."""
    obj = bpy.data.objects.new(name, bpy.data.lights.new(name, "SUN"))
    obj.data.energy, obj.data.color, obj.data.angle = energy, (1.0, 0.5, 0.25), 0.1
    obj.rotation_euler = towards
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return obj


def drawn_layer(addon, layer):
    """What the panels Layers and Advanced draw of a layer."""
    return drawn(addon.ui.fields.draw_layer, layer) + drawn(addon.ui.details.draw_layer, layer)


def drawn_base(addon, base):
    """What the panels Below and Advanced draw of a base."""
    return drawn(addon.ui.fields.draw_base, base) + drawn(addon.ui.details.draw_base, base)

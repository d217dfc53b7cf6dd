# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps that the stories share. Those that are generators yield the seconds until their next look."""

import importlib

import blender_window as window
import bpy

PACKAGE = "bl_ext.user_default.lamina"


def part(name):
    return importlib.import_module(f"{PACKAGE}.{name}")


def layered(panel):
    """The cube's material with one layer of dust over grey, at preview quality."""
    material = bpy.context.object.active_material
    with window.on(panel):
        if not material.lamina.enabled:
            bpy.ops.lamina.add_stack()
    material.lamina.quality = "preview"
    return material


def slowly_baking(panel, material):
    """Layers whose bake takes several seconds; the bake is running afterwards."""
    by_hand()
    material.lamina.quality = "final"
    material.lamina.layers[0].tau = 1.7
    material.lamina.layers[0].g = 0.9
    with window.on(panel):
        bpy.ops.lamina.bake("INVOKE_DEFAULT")
    yield 0.2
    assert part("baking.bake_job").running_for(material) is not None


def baked(panel, material):
    with window.on(panel):
        bpy.ops.lamina.bake("INVOKE_DEFAULT")
    yield from until(lambda: part("baking.bake_job").running() is None)
    assert part("baking.bake_job").failure(material) == ""


def push(message):
    """An undo step, as a button in the panel makes one after its change."""
    bpy.ops.ed.undo_push(message=message)


def unfold_ball():
    """Show the material's ball in the Material tab."""
    ball = bpy.types.CYCLES_MATERIAL_PT_preview
    bpy.utils.unregister_class(ball)
    ball.bl_options = set()
    bpy.utils.register_class(ball)


def preview_rendered(panel, material, number):
    """Change the material, until Cycles renders its ball. Nodes must not change during an earlier render: Blender 4.3
    may crash then."""
    yield from until(lambda: not bpy.app.is_job_running("RENDER_PREVIEW"), step=0.01)
    material.diffuse_color[0] = 0.1 * number
    material.node_tree.nodes[0].location.x += 1.0
    material.node_tree.update_tag()
    panel.tag_redraw()
    yield from until(lambda: bpy.app.is_job_running("RENDER_PREVIEW"), step=0.01)


def info_log():
    """The text of the Info log."""
    (area,) = (area for area in window.WINDOW.screen.areas if area.type == "INFO")
    with window.on(area):
        bpy.ops.info.select_all(action="SELECT")
        bpy.ops.info.report_copy()
    return bpy.context.window_manager.clipboard


def check_images():
    """Every image and group that a node uses is in the file: a pointer to one that undo has freed crashes Blender."""
    known = {one.as_pointer() for one in (*bpy.data.images, *bpy.data.node_groups)}
    trees = [*bpy.data.node_groups, *(one.node_tree for one in bpy.data.materials if one.node_tree)]
    for node in (node for tree in trees for node in tree.nodes):
        used = getattr(node, "image", None) or (getattr(node, "node_tree", None) if node.type == "GROUP" else None)
        assert used is None or used.as_pointer() in known, f"{node.id_data.name}: {node.name} uses a freed data-block"


def at_rest():
    """Until all updates are shown, in the quality of the material."""
    yield 0.1
    yield from until(lambda: not part("baking.update").are_pending())


def by_hand():
    """Bake at the button only, and in the quality of the material."""
    bpy.context.preferences.addons[PACKAGE].preferences.automatic = False


def until(holds, longest=120.0, step=0.1):
    waited = 0.0
    while not holds():
        yield step
        waited += step
        assert waited < longest, "waited too long"

# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender window: what users do with the panel, told as generators. Argument: the name of a story.

Each yielded value is the time in seconds for Blender to handle events and to draw. A story ends by an exception if
something is wrong. What Blender prints of errors in panels and timers is for the test to judge.
"""

import faulthandler
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import blender_window as window
from assets import asset_dropped  # noqa: F401 (found by its name)
from random_actions import random_actions  # noqa: F401 (found by its name)
from steps import (
    PACKAGE,
    at_rest,
    baked,
    by_hand,
    check_images,
    info_log,
    layered,
    part,
    preview_rendered,
    push,
    slowly_baking,
    unfold_ball,
    until,
)

OUT = Path(__file__).parent


def panel_drawn(panel):
    """The panel's buttons become visible: the picture of the Material tab changes when Lamina is added."""
    before = window.picture(panel).copy()
    with window.on(panel):
        bpy.ops.lamina.add_stack()
    yield from window.still()
    after = window.picture(panel)
    window.save(OUT / "panel.png", after)
    assert (before != after).any(axis=2).mean() > 0.05


def bake(panel):
    material = layered(panel)
    yield from baked(panel, material)
    assert part("baking.bake_job").state(material) == "fresh"


def cancel(panel):
    """A bake that is cancelled leaves the earlier one."""
    material = layered(panel)
    yield from baked(panel, material)
    earlier = material.lamina.result.stack_hash
    yield from slowly_baking(panel, material)
    with window.on(panel):
        bpy.ops.lamina.cancel(work="BAKE")
    while part("baking.bake_job").running() is not None:
        yield 0.1
    assert material.lamina.result.stack_hash == earlier and material.lamina.node_group is not None


def update(panel):
    """A changed albedo is shown by itself, at last in the quality of the material, and undo brings back the albedo and
    its bake."""
    material = layered(panel)
    yield from baked(panel, material)
    material.lamina.quality = "final"
    with window.on(panel):
        bpy.ops.ed.undo_push(message="before")
        material.lamina.layers[0].albedo = (0.2, 0.5, 0.8)
        bpy.ops.ed.undo_push(message="blue")
    assert part("baking.bake_job").state(material) == "stale"
    yield from at_rest()
    assert part("baking.bake_job").state(material) == "fresh" and material.lamina.result.quality == "final"
    blue = material.lamina.result.stack_hash
    with window.on(panel):
        bpy.ops.ed.undo()
    material = bpy.context.object.active_material
    assert material.lamina.layers[0].albedo[0] > 0.3
    yield from at_rest()
    assert part("baking.bake_job").state(material) == "fresh" and material.lamina.result.stack_hash != blue


def render(panel):
    """F12 right after a change renders the final picture of that change."""
    seen = []
    bpy.app.handlers.render_pre.append(lambda *_: seen.append(part("baking.bake_job").state(material)))
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.use_denoising, scene.render.resolution_percentage = 1, False, 10
    material = layered(panel)
    yield from baked(panel, material)
    material.lamina.quality = "final"
    for number, albedo in enumerate((0.3, 0.5, 0.7)):
        material.lamina.layers[0].albedo = (albedo,) * 3
        yield 0.3 * number
        with window.on(panel):
            bpy.ops.render.render("INVOKE_DEFAULT")
        yield from until(lambda number=number: len(seen) > number and not bpy.app.is_job_running("RENDER"))
    assert seen == ["fresh"] * 3, seen


def preset_by_picture(panel, preset="dusty-lacquer"):
    """A click on a preset's picture applies it and bakes; two undos, of the nodes and of the click, bring back the
    material without layers."""
    before = window.picture(panel).copy()
    with window.on(panel):
        bpy.ops.ed.undo_push(message="before")
        picker = bpy.context.window_manager.lamina_picker
        picker.category = part("editing.presets").entry(preset).category
        picker.preset = preset
    yield from until(lambda: part("baking.bake_job").state(bpy.context.object.active_material) == "fresh")
    yield from window.still()
    window.save(OUT / f"{preset}.png", window.picture(panel))
    assert (before != window.picture(panel)).any(axis=2).mean() > 0.05
    for _ in range(2):
        with window.on(panel):
            bpy.ops.ed.undo()
        yield from window.still()
    assert not bpy.context.object.active_material.lamina.enabled
    for _ in range(2):
        with window.on(panel):
            bpy.ops.ed.redo()
        yield from window.still()
    assert part("nodes.node_group").is_whole(bpy.context.object.active_material)
    check_images()


def overlay_by_picture(panel):
    """An overlay lies over the Principled BSDF that is there, with breakup."""
    yield from preset_by_picture(panel, "house-dust")
    material = bpy.context.object.active_material
    assert material.lamina.base.kind == "principled" and [one.name for one in material.lamina.layers] == ["dust"]
    assert part("nodes.detail_wiring").detail(material) is not None


def dust_these_objects(panel):
    """The selected cube is dusty after one click, and one undo takes layers and dust away."""
    with window.on(panel):
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.lamina.dust_objects("INVOKE_DEFAULT")
    assert not bpy.context.object.active_material.lamina.enabled, "nothing changes before the end"
    yield from until(lambda: bpy.context.object.lamina_dust.told)
    yield from window.still()
    window.save(OUT / "dusted.png", window.picture(panel))
    yield from at_rest()
    material = bpy.context.object.active_material
    assert part("baking.bake_job").state(material) == "fresh"
    assert part("nodes.thickness").wiring(material).source == "attribute"
    with window.on(panel):
        bpy.ops.ed.undo()
    obj = bpy.context.object
    assert not obj.lamina_dust.told and not obj.active_material.lamina.enabled
    with window.on(panel):
        bpy.ops.ed.redo()
    yield from window.still()
    assert bpy.context.object.lamina_dust.told
    with window.on(panel):
        bpy.ops.lamina.dust_objects_remove()
    yield from window.still()
    assert not bpy.context.object.active_material.lamina.enabled
    check_images()


def places(panel):
    """One click lets an even layer settle, another one paints it; undo brings back each place before."""
    material = layered(panel)
    yield from baked(panel, material)
    push("even")

    def now():
        material = bpy.context.object.active_material
        return part("scene.place").of(material, material.lamina.layers[0])

    for place in ("SETTLED", "PAINTED"):
        with window.on(panel):
            bpy.ops.lamina.place("INVOKE_DEFAULT", True, place=place)
        yield from until(lambda place=place: now() == place)
        yield from at_rest()
        yield from window.still()
        window.save(OUT / f"{place.lower()}.png", window.picture(panel))
    for place in ("SETTLED", "EVEN"):
        while now() != place:
            with window.on(panel):
                bpy.ops.ed.undo()
            check_images()
            yield 0.5
    assert not bpy.context.object.active_material.lamina.layers[0].varying


def rain(panel):
    """One click puts drops over the cube, another one puddles; undo brings the drops back, and then no layers."""
    with window.on(panel):
        bpy.ops.lamina.preset_apply("INVOKE_DEFAULT", True, preset="rain-drops")
    material = bpy.context.object.active_material
    chosen = part("nodes.film_wiring").chosen
    yield from until(lambda: chosen(material) == "DROPS")
    yield from at_rest()
    yield from window.still()
    window.save(OUT / "rain.png", window.picture(panel))
    with window.on(panel):
        bpy.ops.lamina.place("INVOKE_DEFAULT", True, place="PUDDLES")
    yield from until(lambda: chosen(bpy.context.object.active_material) == "PUDDLES")
    yield from at_rest()
    while chosen(bpy.context.object.active_material) != "DROPS":
        with window.on(panel):
            bpy.ops.ed.undo()
        check_images()
        yield 0.5
    while bpy.context.object.active_material.lamina.enabled:
        with window.on(panel):
            bpy.ops.ed.undo()
        check_images()
        yield 0.5
    assert chosen(bpy.context.object.active_material) == ""


def undo_after_update(panel):
    """Undo after updates have applied two changes of one bake: the image of that bake is in no undo step."""
    with window.on(panel):
        bpy.ops.lamina.add_over()
    push("over")
    material = bpy.context.object.active_material
    yield from at_rest()
    for thickness in (0.3, 0.6):
        material.lamina.layers[0].tau = thickness
        push(f"thickness {thickness}")
    yield from at_rest()
    with window.on(panel):
        bpy.ops.ed.undo()
    check_images()
    yield from at_rest()
    material = bpy.context.object.active_material
    assert abs(material.lamina.layers[0].tau - 0.3) < 1e-6
    assert part("baking.bake_job").state(material) == "fresh" and part("nodes.node_group").is_whole(material)
    check_images()
    with window.on(panel):
        bpy.ops.ed.redo()
    check_images()
    yield from at_rest()
    material = bpy.context.object.active_material
    assert abs(material.lamina.layers[0].tau - 0.6) < 1e-6
    assert part("baking.bake_job").state(material) == "fresh" and part("nodes.node_group").is_whole(material)


def undo_overlay(panel):
    """Undo of an overlay, as after a click: the update that followed made a node group, and a step of its own."""
    material = layered(panel)
    layer = material.lamina.layers[0]
    layer.varying = True
    yield from baked(panel, material)
    tree = material.node_tree
    checker = tree.nodes.new("ShaderNodeTexChecker")
    tree.links.new(checker.outputs["Fac"], part("nodes.thickness").group_sockets(material, "Thickness")[0])
    push("layers")
    picker, name = bpy.context.window_manager.lamina_picker, "snow"
    before = [layer.name for layer in material.lamina.layers]
    with window.on(panel):
        picker.category = part("editing.presets").entry(name).category
        picker.preset = name
    yield from at_rest()
    material = bpy.context.object.active_material
    assert [layer.name for layer in material.lamina.layers] != before
    assert part("nodes.detail_wiring").detail(material) is not None
    for _ in range(2):
        with window.on(panel):
            bpy.ops.ed.undo()
        yield from at_rest()
    material = bpy.context.object.active_material
    assert [layer.name for layer in material.lamina.layers] == before, [one.name for one in material.lamina.layers]
    check_images()


def marble(panel):
    """Marble with veins in four clicks: the category, the picture, Veins, and Compute Interior."""
    yield from preset_by_picture(panel, "marble-polished")
    material = bpy.context.object.active_material
    with window.on(panel):
        bpy.ops.lamina.depth(depth="VEINS")
        bpy.ops.lamina.interior("INVOKE_DEFAULT")
    job = part("interior.interior_job")
    yield from until(lambda: job.running() is not None and job.running().shows)
    yield from window.still()
    window.save(OUT / "marble.png", window.picture(panel))
    bpy.ops.lamina.cancel(work="INTERIOR")
    yield from until(lambda: job.running() is None)
    assert part("nodes.node_group").shows_lateral(material)
    check_images()


def soft(panel):
    """Milk on the cube: Automatic chooses how light below the surface is shown, a trial tells the error, and undo takes
    the nodes away."""
    material, job = layered(panel), part("baking.lateral_job")
    layer = material.lamina.layers[0]
    layer.mode, layer.sigma_s, layer.sigma_a, layer.infinite = "coefficients", (0.05,) * 3, (0.001,) * 3, True
    yield from baked(panel, material)
    with window.on(panel):
        bpy.ops.lamina.depth(depth="SOFT")
        push("soft")
        bpy.ops.lamina.lateral("INVOKE_DEFAULT")
    yield from until(lambda: material.lamina.lateral_report and job.running() is None)
    assert material.lamina.trial.startswith("Tried"), (material.lamina.lateral_report, material.lamina.trial)
    push("chosen")
    with window.on(panel):
        assert bpy.ops.lamina.trial("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    yield from until(lambda: "on the whole" in material.lamina.trial and part("interior.trial").running() is None)
    yield from window.still()
    window.save(OUT / "soft.png", window.picture(panel))
    with window.on(panel):
        bpy.ops.ed.undo()
        bpy.ops.ed.undo()
    check_images()
    yield from window.still()


def undo_beside_interior(panel):
    """Undo while the interior shows its first images: no operator has recorded their group and its node. The steps
    before have moved the object, so Blender would keep the material as it is."""
    layered(panel)
    panel.spaces.active.context = "OBJECT"  # a preview of the material would change the material
    push("layers")
    yield 2.0
    for place in (1.0, 2.0):
        bpy.context.object.location.x = place
        yield 1.0
        push("moved")
    yield 2.0
    with window.on(panel):
        bpy.ops.lamina.interior("INVOKE_DEFAULT")
    job = part("interior.interior_job")
    yield from until(lambda: job.running() is None or job.running().shows)
    for operator in (bpy.ops.ed.undo, bpy.ops.ed.redo, bpy.ops.ed.undo):
        with window.on(panel):
            operator()
        check_images()
        yield 0.5
    if job.running() is not None:
        bpy.ops.lamina.cancel(work="INTERIOR")
    yield from until(lambda: job.running() is None)
    check_images()


def beside_previews(panel):
    """The interior is computed, and dust settles, while the material's ball is rendered by Cycles."""
    material = layered(panel)
    unfold_ball()
    dust = bpy.context.object.lamina_dust  # a settling of many seconds, which the story cancels
    dust.target, dust.size, dust.rays = "image", 2048, 65536
    interior = part("interior.interior_job"), bpy.ops.lamina.interior, "INTERIOR"
    dust = part("settling.dust_job"), bpy.ops.lamina.dust_settle, "DUST"
    for number, (job, start, work) in enumerate((interior, dust) * 2):
        yield from preview_rendered(panel, material, number)
        with window.on(panel):
            start("INVOKE_DEFAULT")
        yield from until(lambda job=job: job.running() is not None, step=0.02)
        bpy.ops.lamina.cancel(work=work)
        yield from until(lambda job=job: job.running() is None)


def previews_stopped_quietly(panel):
    """A stopped render of a preview writes no line to the Info log; the test sees what Blender prints."""
    material = layered(panel)
    unfold_ball()
    for number in range(4):
        yield 1.0
        yield from preview_rendered(panel, material, number)
        before = info_log()
        part("base.renders").stop_previews()
        stops = bpy.app.version >= part("base.renders").STOPS_PREVIEWS
        assert not (stops and bpy.app.is_job_running("RENDER_PREVIEW")), "the render goes on"
        assert info_log() == before


def another_file(panel):
    """Another file is opened while a bake runs: the bake ends and changes nothing there."""
    by_hand()
    material = layered(panel)
    path = str(OUT / "another.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    yield from slowly_baking(panel, material)
    bpy.ops.wm.open_mainfile(filepath=path, load_ui=False)
    yield 1.0
    assert part("baking.bake_job").running() is None
    assert all(one.lamina.node_group is None for one in bpy.data.materials)


def disabled(panel):
    """The add-on is disabled while a bake runs, and enabled again."""
    material = layered(panel)
    yield from slowly_baking(panel, material)
    bpy.ops.preferences.addon_disable(module=PACKAGE)
    yield from window.still()
    assert not hasattr(bpy.types.Material, "lamina")
    bpy.ops.preferences.addon_enable(module=PACKAGE)
    yield from window.still()
    assert len(bpy.context.object.active_material.lamina.layers) > 0


def quit_while_baking(panel):
    """Blender is quit while a bake runs: the process ends by itself with exit code 0."""
    material = layered(panel)
    yield from slowly_baking(panel, material)
    bpy.ops.wm.quit_blender()
    yield 60.0
    raise AssertionError("Blender has not quit")


def story(name, *arguments):
    """Opens the Material tab with the cube's material, then tells the story."""
    yield from window.still()
    _view, panel = window.areas()
    bpy.context.scene.render.engine = "CYCLES"
    panel.spaces.active.context = "MATERIAL"
    yield from window.still()
    yield from globals()[name](panel, *arguments)
    print("story ended:", name, flush=True)


if __name__ == "__main__":
    faulthandler.enable()  # in place of Blender's own handler, which does not name the line of Python
    name, *arguments = sys.argv[sys.argv.index("--") + 1:]
    window.perform(story(name, *map(int, arguments)))

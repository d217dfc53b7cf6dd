# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender window: what users do with the panel, told as generators. Argument: the name of a story.

Each yielded value is the time in seconds for Blender to handle events and to draw. A story ends by an exception if
something is wrong. What Blender prints of errors in panels and timers is for the test to judge.
"""

import faulthandler
import importlib
import random
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import blender_window as window

PACKAGE = "bl_ext.user_default.lamina"
OUT = Path(__file__).parent


def part(name):
    return importlib.import_module(f"{PACKAGE}.{name}")


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
    """A click on a preset's picture applies it and bakes; undo brings back the material without layers."""
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
    with window.on(panel):
        bpy.ops.ed.undo()
    yield from window.still()
    assert not bpy.context.object.active_material.lamina.enabled
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


def random_actions(panel, seed, count):
    """`count` random clicks and values in the panel, presets, undo and redo, with a viewport that Cycles renders now
    and then. Pauses are short or long enough for a bake."""
    chance = random.Random(seed)
    layered(panel)
    push("layers")
    for _ in range(count):
        faulthandler.dump_traceback_later(HANGING, exit=True)
        chance.choices([act, step_in_time, take_preset, shade], [10, 4, 2, 1])[0](panel, chance)
        check_images()
        yield chance.choice([0.02, 0.02, 0.3, 1.0])
        check_images()
    part("baking.bake_job").stop()
    part("baking.update").stop()


def act(panel, chance):
    """One random click, or a random value of a random property."""
    material = bpy.context.object.active_material
    if chance.random() < 0.5 and material.lamina.layers:
        settings = material.lamina
        change(chance.choice([settings, settings.base, settings.interior, *settings.layers]), chance)
        push("value")
        return
    name = chance.choice([name for name in dir(bpy.ops.lamina) if name not in NEVER])
    ways = ["INVOKE_DEFAULT"] if name in LONG else ["INVOKE_DEFAULT", "EXEC_DEFAULT"]
    click(panel, name, chance.choice(ways))


def click(panel, name, way, **arguments):
    """Call an operator where its button is active. An error that the operator reports is no failure."""
    operator = getattr(bpy.ops.lamina, name)
    with window.on(panel):
        try:
            if operator.poll():
                operator(way, True, **arguments)
        except RuntimeError as error:
            assert "Traceback" not in str(error), f"lamina.{name}: {error}"
        except TypeError as error:  # an argument that the panel's button gives is missing
            assert "required" in str(error) or "enum" in str(error), f"lamina.{name}: {error}"


def step_in_time(panel, chance):
    """Undo or redo, sometimes several times."""
    operator = chance.choice([bpy.ops.ed.undo, bpy.ops.ed.undo, bpy.ops.ed.redo])
    for _ in range(chance.choice([1, 1, 3])):
        with window.on(panel):
            if operator.poll():
                operator()


def take_preset(panel, chance):
    click(panel, "preset_apply", "EXEC_DEFAULT", preset=chance.choice(PRESETS))


def shade(_panel, chance):
    (view,) = (area for area in window.WINDOW.screen.areas if area.type == "VIEW_3D")
    view.spaces.active.shading.type = chance.choice(["RENDERED", "RENDERED", "SOLID"])


def change(owner, chance):
    """Give a random property of `owner` a random value within its limits."""
    known = [one for one in owner.bl_rna.properties if not one.is_readonly and one.identifier != "name"]
    chosen = chance.choice(known)
    if chosen.type == "BOOLEAN":
        value = chance.random() < 0.5
    elif chosen.type == "ENUM":
        value = chance.choice([item.identifier for item in chosen.enum_items] or [None])
    elif chosen.type in ("FLOAT", "INT"):
        one = (chance.uniform if chosen.type == "FLOAT" else chance.randint)(chosen.soft_min, chosen.soft_max)
        value = [one] * chosen.array_length if chosen.is_array else one
    else:
        return
    if value is not None and not (chosen.type == "ENUM" and chosen.is_enum_flag):
        setattr(owner, chosen.identifier, value)


# Seconds without a step, after which Blender ends with what its threads do. A step may wait for a preview, whose shader
# software OpenGL compiles in up to 40 seconds of processor time: minutes on a busy machine.
HANGING = 900.0
# Matte, a metal, with varying dust, a sheet, and one with translucent layers.
PRESETS = ("paper", "gold", "dusty-bronze", "leaf", "skin-light")
# Operators that open a file dialogue, which waits for a user, and those that the add-on calls.
NEVER = ("stack_export", "stack_import", "preset_save", "profile_replace", "phase_replace", "timer", "stop_previews")
# Long work runs beside the window, as buttons start it: scripts would wait for its end.
LONG = ("bake", "dust_settle", "interior", "lateral")


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

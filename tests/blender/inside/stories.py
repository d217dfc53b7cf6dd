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
        bpy.ops.lamina.bake_cancel()
    while part("baking.bake_job").running() is not None:
        yield 0.1
    assert material.lamina.result.stack_hash == earlier and material.lamina.node_group is not None


def live(panel):
    """A changed albedo is baked by itself, and undo brings back the albedo and its bake."""
    material = layered(panel)
    yield from baked(panel, material)
    material.lamina.live = True
    with window.on(panel):
        bpy.ops.ed.undo_push(message="before")
        material.lamina.layers[0].albedo = (0.2, 0.5, 0.8)
        bpy.ops.ed.undo_push(message="blue")
    assert part("baking.bake_job").state(material) == "stale"
    yield from until(lambda: part("baking.bake_job").state(material) in ("fresh", "live"))
    blue = material.lamina.result.stack_hash
    with window.on(panel):
        bpy.ops.ed.undo()
    material = bpy.context.object.active_material
    assert material.lamina.layers[0].albedo[0] > 0.3
    yield from until(lambda: part("baking.bake_job").state(material) in ("fresh", "live"))
    assert material.lamina.result.stack_hash != blue


def another_file(panel):
    """Another file is opened while a bake runs: the bake ends and changes nothing there."""
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


def random_actions(panel, seed):
    """200 random clicks and values in the panel."""
    chance = random.Random(seed)
    layered(panel)
    for _ in range(200):
        act(panel, chance)
        yield 0.02
    part("baking.bake_job").stop()
    part("baking.live").stop()


def act(panel, chance):
    """One random click, or a random value of a random property. An error that an operator reports is no failure."""
    material = bpy.context.object.active_material
    if chance.random() < 0.5 and material.lamina.layers:
        owner = chance.choice([material.lamina, *material.lamina.layers])
        change(owner, chance)
        return
    name = chance.choice([name for name in dir(bpy.ops.lamina) if name not in NEVER])
    operator = getattr(bpy.ops.lamina, name)
    with window.on(panel):
        try:
            if operator.poll():
                ways = ["INVOKE_DEFAULT"] if name in LONG else ["INVOKE_DEFAULT", "EXEC_DEFAULT"]
                operator(chance.choice(ways))
        except RuntimeError as error:
            assert "Traceback" not in str(error), f"lamina.{name}: {error}"
        except TypeError as error:  # an argument that the panel's button gives is missing
            assert "required" in str(error) or "enum" in str(error), f"lamina.{name}: {error}"


def change(owner, chance):
    """Give a random property of `owner` a random value within its limits."""
    known = [one for one in owner.bl_rna.properties if not one.is_readonly and one.identifier not in ("name", "live")]
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


# Operators that open a file dialogue, which waits for a user, and the one that timers call.
NEVER = ("stack_export", "stack_import", "preset_save", "profile_replace", "phase_replace", "timer")
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


def until(holds, longest=120.0):
    waited = 0.0
    while not holds():
        yield 0.1
        waited += 0.1
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

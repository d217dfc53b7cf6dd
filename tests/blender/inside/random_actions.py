# SPDX-License-Identifier: GPL-3.0-or-later
"""Random clicks and values in the panel. A seed repeats them."""

import faulthandler
import random

import blender_window as window
import bpy
from steps import check_images, layered, part, push

# Seconds without a step, after which Blender ends with what its threads do. A step may wait for a preview, whose shader
# software OpenGL compiles in up to 40 seconds of processor time: minutes on a busy machine.
HANGING = 900.0
# Matte, a metal, with varying dust, a sheet, and one with translucent layers.
PRESETS = ("paper", "gold", "dusty-bronze", "leaf", "skin-light")
# Operators that open a file dialogue, which waits for a user, and those that the add-on calls.
NEVER = ("stack_export", "stack_import", "measured_base", "match_measurement", "preset_save", "profile_replace",
         "phase_replace", "coats_replace", "timer", "stop_previews")
# Long work runs beside the window, as buttons start it: scripts would wait for its end.
LONG = ("bake", "dust_settle", "interior", "lateral", "place", "trial")


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
            try:
                if operator.poll():
                    operator()
            except RuntimeError as error:  # Blender 4.3 lets no script write while a thread starts a Cycles preview
                assert "drawing/rendering" in str(error)


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

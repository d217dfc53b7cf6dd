# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's window on a virtual screen: areas, menus, panels, and screenshots.

The environment variable LAMINA_SCREEN names the screen file, in the format of xwd. Pictures are uint8 arrays
(height, width, 3), top row first.
"""

import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

WINDOW = bpy.context.window_manager.windows[0]
SCREEN = Path(os.environ["LAMINA_SCREEN"])
PANEL_WIDTH = 560  # pixels
DRAWING = 1.0  # seconds between two screenshots
GAP, BACKGROUND = 12, 48  # pixels between two parts of a picture, and their grey


def areas():
    """The default workspace with two areas: the viewport and a wide Properties editor."""
    by_type = {area.type: area for area in WINDOW.screen.areas}
    for name in ("OUTLINER", "DOPESHEET_EDITOR"):
        with on(by_type[name]):
            bpy.ops.screen.area_close()
    view, panel = by_type["VIEW_3D"], by_type["PROPERTIES"]
    with on(panel):
        bpy.ops.screen.area_move(x=panel.x - 1, y=panel.y + 200, delta=panel.width - PANEL_WIDTH)
    with on(view):
        bpy.ops.screen.area_split(direction="HORIZONTAL", factor=0.5)
    lower, view = sorted((area for area in WINDOW.screen.areas if area.type == "VIEW_3D"), key=lambda area: area.y)
    lower.type = "INFO"
    WINDOW.screen.show_statusbar = False
    return view, panel


def menu(area, name, left, right, down):
    """Open a menu `left` pixels from the area's left edge, and point at the entry `right` and `down` pixels from the
    first entry.

    Closes the menu again. Returns the screen with the open menu, and the screen before the menu was opened."""
    left, top = area.x + left, area.y + area.height - 60
    WINDOW.event_simulate(type="MOUSEMOVE", value="NOTHING", x=left, y=top)
    yield from still()
    before = picture().copy()
    with on(area):
        bpy.ops.wm.call_menu("INVOKE_DEFAULT", name=name)
    WINDOW.event_simulate(type="MOUSEMOVE", value="NOTHING", x=left + right, y=top - down)
    yield from still()
    after = picture().copy()
    WINDOW.event_simulate(type="ESC", value="PRESS")
    yield from still()
    return after, before


def show(area, *names):
    """Show only these panels of Lamina and the list of materials in the Material tab."""
    for cls in bpy.types.Panel.__subclasses__():
        kept = cls.__name__ in ("LAMINA_PT_top", "LAMINA_PT_main") or "_PT_context_" in cls.__name__
        if getattr(cls, "bl_context", "") == "material" and cls.is_registered and not kept:
            bpy.utils.unregister_class(cls)
    for name in names:
        cls = next(cls for cls in bpy.types.Panel.__subclasses__() if cls.__name__ == "LAMINA_PT_" + name)
        cls.bl_options = set()  # open
        bpy.utils.register_class(cls)
    area.tag_redraw()


def on(area):
    """Context override for operators: the window and this area."""
    return bpy.context.temp_override(window=WINDOW, screen=WINDOW.screen, area=area, region=region_of(area))


def region_of(area):
    """The area's main region."""
    return next(region for region in area.regions if region.type == "WINDOW")


def still(steps=2, longest=40):
    """Wait until the screen has not changed for `steps` steps, but at most for `longest` steps."""
    earlier, same = None, 0
    for _ in range(longest):
        yield DRAWING
        now = SCREEN.read_bytes()
        same = same + 1 if now == earlier else 0
        if same == steps:
            return
        earlier = now


def picture(part=None):
    """Pixels of an area or region, or of the complete screen."""
    data = SCREEN.read_bytes()
    header = np.frombuffer(data, ">u4", 25)
    size, width, height, stride, colours = (int(header[k]) for k in (0, 4, 5, 12, 19))
    rows = np.frombuffer(data, np.uint8, height * stride, size + 12 * colours).reshape(height, stride)
    pixels = rows[:, : 4 * width].reshape(height, width, 4)[:, :, 2::-1]
    return pixels if part is None else cut(pixels, part)


def cut(pixels, part):
    """Crop the pixels of the screen to an area or region."""
    top = pixels.shape[0] - part.y - part.height
    return pixels[top : top + part.height, part.x : part.x + part.width]


def changed(before, after):
    """The rectangle of `after` that differs from `before`."""
    rows, columns = (np.flatnonzero((before != after).any(axis=2).any(axis=axis)) for axis in (1, 0))
    return after[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def trimmed(pixels, margin=8):
    """Remove the empty rows at the bottom, except for a margin."""
    empty = (pixels == pixels[-4, pixels.shape[1] // 2]).all(axis=2).mean(axis=1) > 0.9
    last = np.flatnonzero(~empty[:-8]).max()
    return pixels[: last + margin]


def beside(*parts):
    """Join pictures from left to right, with their tops aligned."""
    height, width = max(part.shape[0] for part in parts), sum(part.shape[1] + GAP for part in parts) - GAP
    pixels, left = np.full((height, width, 3), BACKGROUND, np.uint8), 0
    for part in parts:
        pixels[: part.shape[0], left : left + part.shape[1]] = part
        left += part.shape[1] + GAP
    return pixels


def save(path, pixels):
    """Write pixels as PNG or JPEG, depending on the path's extension."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(path.name, width, height)
    rgba = np.ones((height, width, 4), np.float32)
    rgba[:, :, :3] = pixels[::-1] / 255.0
    image.pixels.foreach_set(rgba.ravel())
    image.file_format = "JPEG" if path.suffix == ".jpg" else "PNG"
    image.save(filepath=str(path), quality=88)
    bpy.data.images.remove(image)
    print(f"{path.name}: {width} x {height}, {path.stat().st_size / 1000:.0f} kB", flush=True)


def perform(story):
    """Perform the steps of a generator by Blender's timer, and end Blender: with exit code 1 after an exception.

    Each value of the generator is the time in seconds before the next step."""
    bpy.context.preferences.view.show_splash = bpy.context.preferences.view.show_tooltips = False

    class Step(bpy.types.Operator):
        """One step; operators may write to data-blocks, and timers in Blender 4.3 not always"""

        bl_idname = "lamina_test.step"
        bl_label = "Step"
        bl_options = {"INTERNAL"}

        def execute(self, _context):
            take()
            return {"FINISHED"}

    def take(_manager=None, _context=None):
        nonlocal wait
        wait = taken()

    bpy.utils.register_class(Step)
    bpy.types.WindowManager.lamina_test_step = bpy.props.BoolProperty(update=take)
    wait = 0.0

    def step():
        try:
            bpy.ops.lamina_test.step("EXEC_DEFAULT", True)  # True: operators inside may make undo steps
        except RuntimeError:  # Blender 4.3 refuses operators too after some previews; updates of properties may write
            bpy.context.window_manager.lamina_test_step = True
        return wait

    def taken():
        try:
            with bpy.context.temp_override(window=WINDOW):
                return next(story)
        except StopIteration:
            sys.stdout.flush()
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)

    bpy.app.timers.register(step, first_interval=DRAWING, persistent=True)

# SPDX-License-Identifier: GPL-3.0-or-later
"""A story of tests/blender: a material of the asset library is dragged onto an object."""

from pathlib import Path

import blender_window as window
import bpy
from steps import check_images, part, push, until

OUT = Path(__file__).parent
NAME = "Dusty lacquer"


def drag(start, end, steps=8):
    """Drag with the left button between two places (x, y) of the window."""
    def event(place, kind="MOUSEMOVE", value="NOTHING"):
        window.WINDOW.event_simulate(type=kind, value=value, x=round(place[0]), y=round(place[1]))

    event(start)
    yield 0.5
    event(start, "LEFTMOUSE", "PRESS")
    yield 0.2
    for step in range(1, steps + 1):
        event([a + (b - a) * step / steps for a, b in zip(start, end, strict=True)])
        yield 0.2
    event(end, "LEFTMOUSE", "RELEASE")
    yield 0.5


def library_shown():
    """The asset browser with the library in the lower area; returns the area."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    library = libraries.new(name="Lamina", directory=str(OUT / "Lamina Materials"))
    (area,) = (area for area in window.WINDOW.screen.areas if area.type == "INFO")
    area.ui_type = "ASSETS"
    space = area.spaces.active
    yield from until(lambda: space.params is not None)
    space.show_region_toolbar = False  # the catalogs
    space.params.asset_library_reference = library.name
    yield from window.still()
    return area


def asset_dropped(panel):
    """The material is dropped on the cube, is whole there and up to date; undo brings back the cube's own material."""
    (view,) = (area for area in window.WINDOW.screen.areas if area.type == "VIEW_3D")
    own = bpy.context.object.active_material.name
    browser = yield from library_shown()
    push("before")
    tiles, around = window.region_of(browser), window.region_of(view)
    window.save(OUT / "assets.png", window.picture())
    yield from drag((tiles.x + 60, tiles.y + tiles.height - 60),
                    (around.x + around.width / 2, around.y + around.height / 2))
    yield from until(lambda: bpy.context.object.active_material.name == NAME, longest=20.0)
    material = bpy.context.object.active_material
    assert part("nodes.node_group").is_whole(material)
    assert part("baking.bake_job").state(material) == "fresh"
    assert part("nodes.detail_wiring").detail(material) is not None
    view.spaces.active.shading.type = "RENDERED"
    yield from window.still()
    window.save(OUT / "dropped.png", window.picture())
    view.spaces.active.shading.type = "SOLID"
    yield from window.still()
    with window.on(panel):
        bpy.ops.ed.undo()
    assert bpy.context.object.active_material.name == own
    check_images()

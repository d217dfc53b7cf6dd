# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of docs/artists.md. tools/screenshots.sh runs this file in a Blender window on a virtual screen.

Arguments after `--`: the extension's zip, and the folder for the pictures.

`story` performs the steps of the guide. Each yielded value is the time in seconds for Blender to handle events and to
draw before the next step.
"""

import importlib
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import blender_window as screen
from blender_window import DRAWING, beside, cut, on, picture, save, show, still, trimmed

ZIP, OUT = (Path(name).resolve() for name in sys.argv[sys.argv.index("--") + 1:])
PACKAGE = "bl_ext.user_default.lamina"
RENDERED = 25  # a rendered viewport counts as complete after this number of steps without a change


def story():
    yield from still()
    view, panel = screen.areas()
    yield from still()
    stage(view)
    window = screen.region_of(panel)
    yield from still()

    view.type = "PREFERENCES"
    bpy.context.preferences.active_section = "EXTENSIONS"
    from_disk, _without = yield from screen.menu(view, "USERPREF_MT_extensions_settings", view.width - 60, 0, 98)
    with on(view):
        bpy.ops.extensions.package_install_files(filepath=str(ZIP), repo="user_default", enable_on_install=True)
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "Lamina"
    bpy.ops.preferences.addon_expand(module=PACKAGE)
    yield from still()
    save(OUT / "artists-install.png", beside(trimmed(cut(from_disk, view)), trimmed(picture(view))))

    show(panel)
    view.type = "VIEW_3D"
    panel.spaces.active.context = "MATERIAL"
    yield from still()
    save(OUT / "artists-start.png", trimmed(picture(window)))

    show(panel, "layers", "where", "base")
    material = bpy.data.materials["Material"]
    material.lamina.quality = "preview"
    after, before = yield from screen.menu(view, "LAMINA_MT_presets", 20, 390, 40)
    save(OUT / "artists-presets.png", screen.changed(before, after))
    with on(panel):
        bpy.ops.lamina.preset_apply(preset="dusty-lacquer")
    update = importlib.import_module(PACKAGE + ".baking.update")
    while update.are_pending():
        yield DRAWING
    yield from still()
    save(OUT / "artists-layers.png", trimmed(picture(window)))

    show(panel)
    yield from still()
    material.lamina.quality = "final"
    while update.are_pending():
        yield 0.2
        job = update.running_for(material)
        if job is not None and job.fraction < 0.7:
            running = picture(window).copy()
    yield from still()
    save(OUT / "artists-bake.png", beside(trimmed(running), trimmed(picture(window))))

    show(panel, "layers")
    view.spaces.active.shading.type = "RENDERED"
    material.lamina.layers[0].colour = (0.62, 0.50, 0.36)
    while update.are_pending():
        yield DRAWING
    yield from still(RENDERED)
    save(OUT / "artists-update.jpg", beside(picture(view), trimmed(picture(window))))

    show(panel, "layers", "where")
    with on(panel):
        bpy.ops.lamina.place(place="IMAGE")
    thickness = importlib.import_module(PACKAGE + ".nodes.thickness")
    thickness.wire_thickness(material, "image", dust_map())
    yield from still(RENDERED)
    save(OUT / "artists-thickness.jpg", beside(picture(view), trimmed(picture(window))))

    show(panel, "where")
    with on(view):
        bpy.ops.object.delete()
        bpy.ops.mesh.primitive_monkey_add(rotation=(-0.3, 0.0, 0.6))
        bpy.ops.object.subdivision_set(level=2)
        bpy.ops.object.modifier_apply(modifier="Subdivision")
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(material)
    yield from still()
    with on(panel):
        bpy.ops.lamina.place(place="SETTLED")
    yield from still(RENDERED)
    save(OUT / "artists-dust.jpg", beside(picture(view), trimmed(picture(window))))

    view.spaces.active.shading.type = "SOLID"  # beside a rendered viewport the render does not finish
    yield from still()
    bpy.ops.render.render()
    bpy.data.images["Render Result"].save_render(str(OUT / "artists-render.jpg"))


def stage(view):
    """Set up Cycles, a floor, a sky and a sun. The viewport shows the camera view without overlays."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.preview_samples = 64, 32
    scene.cycles.use_denoising = scene.cycles.use_preview_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 480, 360
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 88
    scene.camera.data.lens = 85.0
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    sky = nodes.new("ShaderNodeTexSky")
    sky.sun_disc = False
    nodes["Background"].inputs["Strength"].default_value = 0.15
    links.new(sky.outputs[0], nodes["Background"].inputs["Color"])
    bpy.data.objects["Light"].data.type = "SUN"
    bpy.data.objects["Light"].data.energy = 3.0
    with on(view):
        cube = bpy.context.object
        bpy.ops.mesh.primitive_plane_add(size=40.0, location=(0.0, 0.0, -1.0))
        bpy.context.object.select_set(False)
        cube.select_set(True)
        bpy.context.view_layer.objects.active = cube
    space = view.spaces.active
    space.overlay.show_overlays = space.show_gizmo = space.show_region_toolbar = False
    space.region_3d.view_rotation = scene.camera.matrix_world.to_quaternion()
    space.region_3d.view_location, space.region_3d.view_distance = (0.0, 0.0, -0.1), 4.5


def dust_map():
    """An image of patchy dust thickness: smooth noise from 0 to 2."""
    noise = np.fft.fft2(np.random.default_rng(1).normal(size=(256, 256)))
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(256), np.fft.fftfreq(256)))
    smooth = np.fft.ifft2(noise * np.exp(-((frequency / 0.02) ** 2))).real
    image = bpy.data.images.new("Dust Map", 256, 256, float_buffer=True, is_data=True)
    values = np.repeat(np.clip(smooth / smooth.std(), 0.0, 2.0).ravel(), 4)
    image.pixels.foreach_set(values.astype(np.float32))
    return image


screen.perform(story())

# SPDX-License-Identifier: GPL-3.0-or-later
"""The slab scene: the standard problem under sun and sky, as a real volume or as the baked plane.

As a module, `build(stack, body, material)` makes a scene. As a script it makes the scene in a running Blender, for
viewing, saving or rendering:

    blender -b -P demo_scenes/slab/scene.py -- [--body volume|baked] [--stack STACK.json]
        [--samples N] [--size PIXELS] [--save FILE.blend] [--render FILE.png]

`--body baked` needs the Lamina extension, enabled. Without --save and --render the scene is only built.
"""

import argparse
import json
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
if __name__ == "__main__":  # `blender -P` adds none of our folders to the module path
    sys.path.insert(0, str(HERE.parent))

import cycles_render  # noqa: E402
from slab import light, view, volume  # noqa: E402

STACK = HERE / "stack.json"
# Light from the box's sides does not reach the compared region: for these stacks the radiance 60 thicknesses inside
# differs by less than 2e-6 from that of an unbounded slab.
HALF_WIDTH = 10000.0
# Paths longer than 32 scatterings carry less than 1e-6 of the standard slab's radiance.
VOLUME_BOUNCES = 64


def load_stack(path=STACK):
    """The stack as a dict."""
    return json.loads(Path(path).read_text(encoding="utf-8"))


def build(stack, body, material=None):
    """A new scene with the slab, sun, sky and camera.

    body: "volume" (boxes of Cycles volume over the stack's base) or "baked" (a plane with `material`). Raises
    ValueError for a stack that cannot be shown as a volume.
    """
    scene = bpy.data.scenes.new(f"slab {body}")
    if body == "volume":
        volume.build(scene, stack, HALF_WIDTH)
    else:
        volume.plane(scene, HALF_WIDTH, material)
    view.build(scene)
    light.build(scene, view.SUN_AZIMUTH)
    return scene


def set_quality(scene, size, samples):
    """Unbiased settings for a picture of `size` x `size` pixels, with the number of bounces that the slab needs."""
    cycles_render.unbiased(scene, size, size, samples, VOLUME_BOUNCES)


def baked_material(stack, quality="final"):
    """(a material baked by the Lamina extension, its LUT)."""
    import extension

    return extension.bake("slab", stack, quality)


def main(argv):
    parser = argparse.ArgumentParser(prog="scene.py", description="Build the slab scene in this Blender.")
    parser.add_argument("--body", choices=("volume", "baked"), default="volume")
    parser.add_argument("--stack", type=Path, default=STACK)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--size", type=int, default=480)
    parser.add_argument("--save", type=Path)
    parser.add_argument("--render", type=Path)
    arguments = parser.parse_args(argv)
    try:
        stack = load_stack(arguments.stack)
        material = baked_material(stack)[0] if arguments.body == "baked" else None
        scene = build(stack, arguments.body, material)
    except (ValueError, OSError, RuntimeError) as error:
        print(f"scene.py: {error}", file=sys.stderr)
        return 1
    set_quality(scene, arguments.size, arguments.samples)
    if bpy.context.window:
        bpy.context.window.scene = scene
    if arguments.save:
        bpy.ops.wm.save_as_mainfile(filepath=str(arguments.save.resolve()))
        print(f"wrote {arguments.save}")
    if arguments.render:
        scene.render.image_settings.file_format = "PNG"
        scene.render.image_settings.color_depth = "8"
        scene.render.filepath = str(arguments.render.resolve())
        bpy.ops.render.render(write_still=True, scene=scene.name)
        print(f"wrote {arguments.render}")
    return 0


if __name__ == "__main__":
    code = main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    if code:  # in a Blender with a window, sys.exit(0) would close Blender
        sys.exit(code)

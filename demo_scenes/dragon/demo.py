# SPDX-License-Identifier: GPL-3.0-or-later
"""A bronze dragon under lacquer: clean, under light and under heavy dust; and turning while the dust grows."""

import dataclasses
import json
import time
from pathlib import Path

import bpy
import cycles_render
import numpy as np
import output
import picture
from PIL import Image, ImageDraw, ImageFont

from . import scene

STACK = Path(__file__).resolve().parent / "stack.json"
OPTIONS = ("mesh", "up", "turntable")  # arguments of run() beyond those of every scene
HEAVY = 4.0  # optical thickness on an open plate, the largest in the table
SHARES = (0.0, 0.125, 1.0)
NAMES = ("Clean", "Light dust", "Heavy dust")
EXPOSURE = 1.2


@dataclasses.dataclass(frozen=True)
class Quality:
    """Pixels of the picture, samples, and the resolution of mesh and table."""

    width: int
    height: int
    samples: int
    fine: bool
    bake: str
    row_stride: int  # step between solved rows of thickness in the table
    rays: int  # per vertex, for the dust
    frame: int  # pixels of a turntable's square frames
    frame_samples: int


QUALITIES = {
    "tiny": Quality(192, 96, 4, False, "preview", 8, 16, 96, 4),
    "small": Quality(960, 480, 24, False, "preview", 8, 48, 240, 16),
    "final": Quality(1920, 960, 256, True, "final", 1, 128, 640, 96),
}


def run(out, quality, stack_path, say, mesh=None, up="y", turntable=0):
    """Render dragon.png, write dragon.json into `out`. Returns (files, verdict, True if all is well).

    mesh: a PLY, OBJ or STL file shown in place of the dragon, with the upright axis `up`; turntable: number of
    additional frames. Raises ValueError, in a sentence."""
    from lamina import dust as layer  # the extension's wheel: not there before the extension is installed

    if layer.available():
        return (), f"dragon: {layer.available()}", False
    setting = QUALITIES[quality]
    stack = load_stack(stack_path or STACK)
    clock = _Clock()
    figure, stand = scene.figure(mesh, up), scene.stand(setting.fine)
    clock.lap("mesh")
    say(f"dragon: {len(figure.polygons)} faces in {clock.seconds['mesh']:.0f} s")
    dusty, lut = scene.material(stack, setting.bake, setting.row_stride)
    clock.lap("bake")
    say(f"dragon: baked in {clock.seconds['bake']:.0f} s, fit error {lut.report['fit_error']:.1%}")
    stage, groups = scene.build(figure, stand, dusty, SHARES)
    dust = scene.settle(groups[0], HEAVY, setting.rays)
    clock.lap("dust")
    say(f"dragon: dust settled in {clock.seconds['dust']:.0f} s")
    pixels = _render(stage, setting.width, setting.height, setting.samples)
    clock.lap("render")
    say(f"dragon: rendered in {clock.seconds['render']:.0f} s")
    files = [out / "dragon.png", out / "dragon.json"]
    _sheet(files[0], picture.tone(pixels, EXPOSURE), [
        f"{name}, optical thickness {share * HEAVY:.2g}" if share else name
        for name, share in zip(NAMES, SHARES, strict=True)
    ])
    if turntable:
        bpy.data.scenes.remove(stage)
        files += _turntable(out, figure, stand, dusty, setting, turntable, say)
        clock.lap("turntable")
    report = lut.report
    output.save_json(files[1], {
        "quality": quality, "mesh": str(mesh) if mesh else "dragon", "faces": len(figure.polygons),
        "vertices": len(figure.vertices), **dataclasses.asdict(setting), "seconds": clock.seconds,
        "dust": {"amount": HEAVY, "shares": SHARES, **dust}, "fit_error": report["fit_error"],
        "row_errors": report.get("row_errors"), "tau_error": report.get("tau_error"),
        "worst_slice": report["worst_slice"], "closures": report["closures"], "stack": stack,
    })
    well = bool(np.isfinite(pixels).all() and pixels.max() > 0.0)
    verdict = (f"{len(figure.polygons)} faces, dust {dust['figure']['mean']:.2f} thick on average, "
               f"fit error {report['fit_error']:.1%}, {sum(clock.seconds.values()):.0f} s")
    return files, verdict if well else f"{verdict}; the picture is black or not finite", well


def load_stack(path):
    """A stack as a dict, without the descriptive texts of presets."""
    stack = json.loads(Path(path).read_text(encoding="utf-8"))
    return {key: value for key, value in stack.items() if key not in ("name", "category", "source")}


class _Clock:
    def __init__(self):
        self.seconds, self._last = {}, time.perf_counter()

    def lap(self, name):
        now = time.perf_counter()
        self.seconds[name], self._last = now - self._last, now


def _render(stage, width, height, samples):
    cycles_render.unbiased(stage, width, height, samples, bounces=4)
    stage.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    # Clamp to reduce noise: nothing is measured from this picture.
    stage.cycles.sample_clamp_indirect = 4.0
    stage.cycles.caustics_reflective = False
    cycles_render.denoised(stage)
    return cycles_render.render(stage)[0]


def _sheet(path, image, captions):
    """The picture over a strip of captions, one below each figure."""
    height, width = image.shape[:2]
    strip, font = max(24, width // 20), ImageFont.load_default(max(5, width // 56))
    sheet = Image.new("RGB", (width, height + strip), picture.PAPER)
    sheet.paste(Image.fromarray(image), (0, 0))
    draw = ImageDraw.Draw(sheet)
    across = width / (len(captions) + scene.MARGIN)
    for k, text in enumerate(captions):
        x = 0.5 * width + (k - 0.5 * (len(captions) - 1)) * across
        draw.text((x, height + strip // 2), text, picture.INK, font, "mm")
    output.place(path, lambda partial: sheet.save(partial, "PNG", optimize=True))


def _turntable(out, figure, stand, dusty, setting, frames, say):
    """`frames` pictures of one turn, from no dust to heavy dust; and all of them as an animated PNG."""
    folder = out / "dragon_turntable"
    folder.mkdir(exist_ok=True)
    stage, (things,) = scene.build(figure, stand, dusty, (0.0,))
    stage.render.use_persistent_data = True
    start, files, images = things[0].rotation_euler.z, [], []
    for k in range(frames):
        for thing in things:
            thing[scene.SHARE] = k / max(frames - 1, 1)
            thing.rotation_euler.z = start + 2.0 * np.pi * k / frames
            thing.update_tag()
        image = Image.fromarray(picture.tone(
            _render(stage, setting.frame, setting.frame, setting.frame_samples), EXPOSURE))
        images.append(image)
        files.append(folder / f"{k:04d}.png")
        output.place(files[-1], lambda partial, image=image: image.save(partial, "PNG", optimize=True))
        say(f"dragon: frame {k + 1} of {frames}")
    moving = out / "dragon_turntable.png"
    output.save_moving(moving, images)
    return [moving]

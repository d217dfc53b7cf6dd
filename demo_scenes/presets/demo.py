# SPDX-License-Identifier: GPL-3.0-or-later
"""All presets of the library on one sheet, by category, with their fit errors."""

import os
import tempfile
import time

import bpy
import cycles_render
import extension
import numpy as np
import output
import picture
from PIL import Image, ImageDraw, ImageFont

from . import scene

# Pixels across a cell, and samples.
QUALITIES = {"tiny": (48, 8), "small": (104, 24), "final": (176, 256)}
COLUMNS = 12
EXPOSURE = 1.1
ROW_STRIDE = 4  # for a varying layer: the picture is too small to show more rows of thickness
LABEL, HEADING, MARGIN = 30, 44, 24
CHECKS = (66, 92)


def run(out, quality, stack_path, say):
    """Bake and render all presets; write presets.png and presets.json into `out`.

    Returns (files, verdict, True if all are well). `stack_path` is not used here."""
    import lamina

    entries = sorted(lamina.presets.entries(), key=lambda entry: (entry.category, entry.name))
    started = time.perf_counter()
    materials, facts = [], []
    for number, entry in enumerate(entries):
        material, fact = _bake(lamina, entry)
        materials.append(material)
        facts.append(fact)
        if (number + 1) % 20 == 0 or number + 1 == len(entries):
            say(f"presets: {number + 1} of {len(entries)} baked")
    baked = time.perf_counter() - started
    size, samples = QUALITIES[quality]
    cells, seconds = _render(materials, [entry.stack.base is None for entry in entries], size, samples)
    say(f"presets: rendered in {seconds:.0f} s")
    files = [out / "presets.png", out / "presets.json"]
    _sheet(files[0], entries, facts, cells, size)
    worst = max(facts, key=lambda fact: fact["fit_error"])
    mean = sum(fact["fit_error"] for fact in facts) / len(facts)
    output.save_json(files[1], {
        "seconds_bakes": baked, "seconds_render": seconds, "mean_fit_error": mean, "presets": facts,
    })
    black = [fact["id"] for fact, cell in zip(facts, cells, strict=True) if not cell[..., :3].any()]
    verdict = f"{len(facts)} presets, fit error {mean:.1%} on average, {worst['fit_error']:.1%} for {worst['name']}"
    return files, verdict + (f"; black: {', '.join(black)}" if black else ""), not black


def _bake(lamina, entry):
    """(material, facts about it)."""
    stack_io, bake_job = extension.part("editing.stack_io"), extension.part("baking.bake_job")
    material = bpy.data.materials.new(entry.id)
    stack_io.assign_stack(material, entry.stack)
    varies = entry.stack.varying is not None
    lut = lamina.bake(entry.stack, "preview", row_stride=ROW_STRIDE if varies else 1)
    bake_job.apply(material, lut)
    if varies:
        node = next(node for node in material.node_tree.nodes if node.type == "GROUP")
        scene.settle(material, node)
    keys = ("fit_error", "fit_error_transmission", "albedo_error", "closures", "seconds")
    return material, {"id": entry.id, "name": entry.name, "category": entry.category,
                      **{key: lut.report[key] for key in keys}, "worst_slice": lut.report["worst_slice"]["error"]}


def _render(materials, sheets, size, samples):
    """([sRGB bytes and alpha (size, size, 4)] of each, seconds)."""
    stage = scene.build(materials, sheets, COLUMNS)
    rows = -(-len(materials) // COLUMNS)
    cycles_render.unbiased(stage, COLUMNS * size, rows * size, samples, bounces=4)
    stage.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    # Clamp to reduce noise: nothing is measured from this picture.
    stage.cycles.sample_clamp_indirect = 10.0
    stage.render.film_transparent = True
    stage.render.image_settings.color_mode = "RGBA"
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "presets.exr")
        stage.render.filepath = path
        with cycles_render.quiet():
            bpy.ops.render.render(write_still=True, scene=stage.name)
        pixels = _read(path)
    seconds = time.perf_counter() - start
    cells = []
    for k in range(len(materials)):
        top, left = k // COLUMNS * size, k % COLUMNS * size
        cells.append(pixels[top : top + size, left : left + size])
    return cells, seconds


def _read(path):
    """Linear RGBA, alpha associated, first row on top."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    image.alpha_mode = "CHANNEL_PACKED"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1].astype(float)


def _sheet(path, entries, facts, cells, size):
    """The picture: a heading and rows of cells for each category."""
    groups = {}
    for k, entry in enumerate(entries):
        groups.setdefault(entry.category, []).append(k)
    rows = sum(-(-len(group) // COLUMNS) for group in groups.values())
    height = MARGIN * 2 + len(groups) * HEADING + rows * (size + LABEL)
    sheet = Image.new("RGB", (2 * MARGIN + COLUMNS * size, height), picture.PAPER)
    draw, small = ImageDraw.Draw(sheet), ImageFont.load_default(max(9, size // 10))
    y = MARGIN
    for category, group in groups.items():
        draw.text((MARGIN, y + HEADING // 2 - 8), category, picture.INK, ImageFont.load_default(18))
        y += HEADING
        for place, k in enumerate(group):
            x = MARGIN + place % COLUMNS * size
            if place and place % COLUMNS == 0:
                y += size + LABEL
            sheet.paste(Image.fromarray(_over_paper(cells[k], entries[k].stack.base is None)), (x, y))
            for number, line in enumerate(_lines(entries[k].name, draw, small, size - 6)):
                draw.text((x + size // 2, y + size + number * 13), line, picture.FAINT, small, "ma")
        y += size + LABEL
    output.place(path, lambda partial: sheet.save(partial, "PNG", optimize=True))


def _over_paper(cell, is_sheet):
    """sRGB bytes; a sheet lies over a chequered ground that is seen through it."""
    size = len(cell)
    paper = np.broadcast_to(np.array(picture.PAPER, float), (size, size, 3)).copy()
    if is_sheet:
        across, down = np.meshgrid(np.arange(size) * 8 // size, np.arange(size) * 8 // size)
        paper[:] = np.where((across + down) % 2, *CHECKS)[..., None]
    linear = -np.log(1.0 - np.minimum(_linear(paper / 255.0), 0.999)) / EXPOSURE
    return picture.tone(cell[..., :3] + (1.0 - cell[..., 3:]) * linear, EXPOSURE)


def _linear(encoded):
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def _lines(text, draw, font, width):
    """A name on at most two lines."""
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and draw.textlength(longer, font) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines[:2]

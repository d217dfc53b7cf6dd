# SPDX-License-Identifier: GPL-3.0-or-later
"""All presets of the library on one sheet, by category, with their fit errors; and a picture of each for the panel."""

import time
from pathlib import Path

import cycles_render
import extension
import output
import picture
from dragon import settling
from PIL import Image, ImageDraw, ImageFont

from . import overlays as over
from . import scene

# Pixels across a cell, samples, and rays of the dust.
QUALITIES = {"tiny": (48, 4, 16), "small": (104, 24, 64), "final": (224, 48, 256)}
OPTIONS = ("thumbnails", "overlays")  # arguments of run() beyond those of every scene
THUMBNAIL, THUMBNAIL_QUALITY = 112, 88  # pixels across, and JPEG's quality
COLUMNS = 12
EXPOSURE = 0.95
ROW_STRIDE = 4  # for a varying layer: the picture is too small to show more rows of thickness
HEADING, MARGIN = 44, 24


def run(out, quality, stack_path, say, thumbnails=None, overlays=False):
    """Bake and render all presets; write presets.png and presets.json into `out`.

    thumbnails: a folder for a small picture of each preset. overlays: only overlays.png, with each overlay over ten
    materials. Returns (files, verdict, True if all are well). `stack_path` is not used here."""
    import lamina

    if overlays:
        return _overlays(lamina, out, quality, say)
    known = lamina.presets.entries()
    entries = sorted(filter(extension.part("editing.presets").can_be_shown, known),
                     key=lambda entry: (entry.category, entry.name))
    started = time.perf_counter()
    materials, facts = [], []
    for number, entry in enumerate(entries):
        material, fact = _bake(lamina, entry, scene.below(entry.id))
        materials.append(material)
        facts.append(fact)
        if (number + 1) % 20 == 0 or number + 1 == len(entries):
            say(f"presets: {number + 1} of {len(entries)} baked")
    baked = time.perf_counter() - started
    cells, seconds = _render(materials, [_is_sheet(entry) for entry in entries], *QUALITIES[quality], say)
    if thumbnails is not None:
        _thumbnails(Path(thumbnails), entries, cells, {entry.id for entry in known})
    files = [out / "presets.png", out / "presets.json"]
    _sheet(files[0], entries, facts, cells)
    worst = max(facts, key=lambda fact: fact["fit_error"])
    mean = sum(fact["fit_error"] for fact in facts) / len(facts)
    output.save_json(files[1], {
        "seconds_bakes": baked, "seconds_render": seconds, "mean_fit_error": mean, "presets": facts,
    })
    black = [fact["id"] for fact, cell in zip(facts, cells, strict=True) if not cell.any()]
    verdict = f"{len(facts)} presets, fit error {mean:.1%} on average, {worst['fit_error']:.1%} for {worst['name']}"
    return files, verdict + (f"; black: {', '.join(black)}" if black else ""), not black


def _overlays(lamina, out, quality, say):
    """`run` of the sheet of overlays."""
    category = extension.part("editing.presets").OVERLAYS
    entries = [entry for entry in lamina.presets.entries() if entry.category == category]
    materials = [over.made(*below) for below in over.MATERIALS]
    for number, entry in enumerate(entries):
        materials += [_bake(lamina, entry, over.made(*below))[0] for below in over.MATERIALS]
        say(f"overlays: {number + 1} of {len(entries)} baked")
    size, samples, rays = QUALITIES[quality]
    cells, _ = _render(materials, [False] * len(materials), size // 2, samples, rays, say)
    over.sheet(out / "overlays.png", ["No overlay", *(entry.name for entry in entries)], cells)
    is_well = all(cell.any() for cell in cells)
    return [out / "overlays.png"], f"{len(entries)} overlays over {len(over.MATERIALS)} materials", is_well


def _is_sheet(entry):
    return entry.stack.base is None and entry.category != extension.part("editing.presets").OVERLAYS


def _bake(lamina, entry, material):
    """(material, facts about it). Overlays lie over the given material."""
    presets, stack_io, bake_job, preferences = (extension.part(name) for name in (
        "editing.presets", "editing.stack_io", "baking.bake_job", "base.preferences"))
    presets.apply(material, entry.id)
    varies = entry.stack.varying is not None
    lut = lamina.bake(stack_io.to_stack(material), "preview", row_stride=ROW_STRIDE if varies else 1,
                      basis=preferences.table_basis("standard"))
    bake_job.apply(material, lut)
    if varies:
        scene.wire_dust(material)
    scene.scale_film(material)
    keys = ("fit_error", "fit_error_transmission", "albedo_error", "closures", "seconds")
    return material, {"id": entry.id, "name": entry.name, "category": entry.category,
                      **{key: lut.report[key] for key in keys}, "worst_slice": lut.report["worst_slice"]["error"]}


def _render(materials, sheets, size, samples, rays, say):
    """([sRGB bytes (size, size, 3)] of each, seconds)."""
    stage, solid, _ = scene.build()
    settling.settle_on(solid, 1.0, rays=rays)
    cycles_render.unbiased(stage, size, size, samples, bounces=4)
    stage.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    # Clamp and denoise: nothing is measured from these pictures.
    stage.cycles.sample_clamp_indirect = 10.0
    cycles_render.denoised(stage)
    stage.render.use_persistent_data = True
    cells, total = [], 0.0
    for number, (material, is_sheet) in enumerate(zip(materials, sheets, strict=True)):
        scene.show(stage, material, is_sheet)
        pixels, seconds = cycles_render.render(stage)
        cells.append(picture.tone(pixels, EXPOSURE))
        total += seconds
        if (number + 1) % 20 == 0 or number + 1 == len(materials):
            say(f"presets: {number + 1} of {len(materials)} rendered in {total:.0f} s")
    return cells, total


def _thumbnails(folder, entries, cells, known):
    """One JPEG per preset, named by its id; pictures are removed that belong to no preset of the ids `known`."""
    folder.mkdir(parents=True, exist_ok=True)
    for entry, cell in zip(entries, cells, strict=True):
        small = Image.fromarray(cell).resize((THUMBNAIL, THUMBNAIL), Image.Resampling.LANCZOS)
        output.place(folder / f"{entry.id}.jpg",
                     lambda partial, small=small: small.save(partial, "JPEG", quality=THUMBNAIL_QUALITY))
    for path in folder.glob("*.jpg"):
        if path.stem not in known:
            path.unlink()


def _sheet(path, entries, facts, cells):
    """The picture: a heading and rows of cells for each category."""
    size = len(cells[0])
    letters = max(9, size // 10)
    step, label = letters + 4, 2 * letters + 12
    groups = {}
    for k, entry in enumerate(entries):
        groups.setdefault(entry.category, []).append(k)
    rows = sum(-(-len(group) // COLUMNS) for group in groups.values())
    height = MARGIN * 2 + len(groups) * HEADING + rows * (size + label)
    sheet = Image.new("RGB", (2 * MARGIN + COLUMNS * size, height), picture.PAPER)
    draw, small = ImageDraw.Draw(sheet), ImageFont.load_default(letters)
    y = MARGIN
    for category, group in groups.items():
        draw.text((MARGIN, y + HEADING // 2 - 8), category, picture.INK, ImageFont.load_default(18))
        y += HEADING
        for place, k in enumerate(group):
            x = MARGIN + place % COLUMNS * size
            if place and place % COLUMNS == 0:
                y += size + label
            sheet.paste(Image.fromarray(cells[k]), (x, y))
            for number, line in enumerate(_lines(entries[k].name, draw, small, size - 6)):
                draw.text((x + size // 2, y + size + number * step), line, picture.FAINT, small, "ma")
        y += size + label
    output.place(path, lambda partial: sheet.save(partial, "PNG", optimize=True))


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

# SPDX-License-Identifier: GPL-3.0-or-later
"""Three panels side by side: two renders and their difference, with captions and a colour bar."""


import numpy as np
import output
from PIL import Image, ImageDraw, ImageFont

MARGIN, GAP = 24, 16
PAPER, INK, FAINT, OUTSIDE = (22, 23, 26), (236, 236, 232), (156, 158, 162), (48, 50, 54)
LOW, MIDDLE, HIGH = (0.13, 0.42, 0.80), (0.93, 0.93, 0.92), (0.80, 0.24, 0.14)  # sRGB values


def save(path, title, panels, difference, span, notes):
    """Write the picture, atomically.

    title: (large line, small line). panels: [(heading, detail, sRGB bytes (h, w, 3))] of two renders. difference:
    (heading, detail, relative values (h, w) with NaN outside the region); the range of the colours is +-`span`. notes:
    up to three lines, [(text, is_plain)], below the renders.
    """
    save_rows(path, title, [(panels, difference, notes)], span)


def save_rows(path, title, rows, span):
    """Several such comparisons of equal size below each other; rows: [(panels, difference, notes)]."""
    height, width = rows[0][1][2].shape
    first, row_height = MARGIN + 84, 56 + height + 96
    sheet = Image.new("RGB", (2 * MARGIN + 3 * width + 2 * GAP, first + len(rows) * row_height + MARGIN), PAPER)
    draw = ImageDraw.Draw(sheet)
    draw.text((MARGIN, MARGIN), title[0], INK, font(28))
    draw.text((MARGIN, MARGIN + 40), title[1], FAINT, font(16))
    for k, row in enumerate(rows):
        _row(sheet, draw, first + k * row_height + 56, *row, span)
    output.place(path, lambda partial: sheet.save(partial, "PNG", optimize=True))


def _row(sheet, draw, top, panels, difference, notes, span):
    heading, detail, values = difference
    height, width = values.shape
    for k, (name, explanation, pixels) in enumerate([*panels, (heading, detail, diverging(values, span))]):
        left = MARGIN + k * (width + GAP)
        draw.text((left, top - 50), name, INK, font(20))
        draw.text((left, top - 24), explanation, FAINT, font(14))
        sheet.paste(Image.fromarray(pixels), (left, top))
    colour_bar(sheet, draw, MARGIN + 2 * (width + GAP), top + height + 16, width, span)
    for k, (text, plain) in enumerate(notes):
        draw.text((MARGIN, top + height + 14 + 26 * k), text, FAINT if plain else INK, font(16))


def tone(pixels, exposure):
    """Linear radiance -> sRGB bytes; highlights roll off as 1 - exp(-x), so none is clipped."""
    linear = 1.0 - np.exp(-exposure * np.maximum(pixels, 0.0))
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(encoded * 255.0).astype(np.uint8)


def block_means(values, region, size):
    """Means of `values` (h, w) over blocks of size x size pixels, within `region`; NaN outside."""
    height, width = values.shape
    result = np.full((height, width), np.nan)
    for y in range(0, height, size):
        for x in range(0, width, size):
            inside = region[y : y + size, x : x + size]
            if inside.any():
                block = result[y : y + size, x : x + size]
                block[inside] = values[y : y + size, x : x + size][inside].mean()
    return result


def blocks(pictures, size):
    """Means over size x size pixels of (n, h, w, channels); incomplete blocks at the edges are dropped."""
    n, height, width, channels = pictures.shape
    rows, columns = height // size, width // size
    cut = pictures[:, : rows * size, : columns * size]
    return cut.reshape(n, rows, size, columns, size, channels).mean(axis=(2, 4))


def diverging(values, span):
    """Blue below zero, grey at zero, red above; NaN is a darker tone of the paper. (h, w) -> bytes (h, w, 3)."""
    position = np.clip(np.nan_to_num(values) / span, -1.0, 1.0)[..., None]
    low, middle, high = np.array(LOW), np.array(MIDDLE), np.array(HIGH)
    colours = np.where(position < 0, middle + (middle - low) * position, middle + (high - middle) * position)
    colours = np.where(np.isnan(values)[..., None], np.array(OUTSIDE) / 255.0, colours)
    return np.round(colours * 255.0).astype(np.uint8)


def colour_bar(sheet, draw, left, top, width, span):
    """Draw the colours of `diverging` and their values."""
    bar = np.broadcast_to(np.linspace(-span, span, width), (14, width))
    sheet.paste(Image.fromarray(diverging(bar, span)), (left, top))
    for share, anchor in ((-1.0, "la"), (-0.5, "ma"), (0.0, "ma"), (0.5, "ma"), (1.0, "ra")):
        x = left + (share + 1.0) / 2.0 * (width - 1)
        draw.line((x, top + 14, x, top + 19), FAINT)
        draw.text((x, top + 24), f"{share * span:+.0%}" if share else "0", FAINT, font(14), anchor)


def font(size):
    """The font of captions."""
    # Pillow's own font is the same on every machine.
    return ImageFont.load_default(size)

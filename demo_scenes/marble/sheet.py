# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of each method side by side, their differences from the truth below, and the numbers as a table."""

import numpy as np
import output
import picture
from PIL import Image, ImageDraw

PANEL, GAP, MARGIN, HEAD, FOOT = 250, 12, 24, 96, 74
SPAN = 0.3  # relative difference at the ends of the colours
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def save(path, title, rows, exposure):
    """Write the sheet, atomically.

    title: (large line, small line). rows: one per body: (pictures by caption, of linear radiance (size, size, 3), the
    truth first; the region of comparison; a list of two short lines of numbers per picture).
    """
    count = max(len(pictures) for pictures, _, _ in rows)
    height = 2 * PANEL + GAP + 30 + FOOT
    sheet = Image.new("RGB", (2 * MARGIN + count * (PANEL + GAP) - GAP, HEAD + len(rows) * height + 2 * MARGIN),
                      picture.PAPER)
    draw = ImageDraw.Draw(sheet)
    draw.text((MARGIN, MARGIN), title[0], picture.INK, picture.font(28))
    draw.text((MARGIN, MARGIN + 40), title[1], picture.FAINT, picture.font(16))
    for k, (pictures, region, numbers) in enumerate(rows):
        _row(sheet, draw, HEAD + k * height, pictures, region, numbers, exposure)
    picture.colour_bar(sheet, draw, MARGIN, HEAD + height - FOOT - PANEL // 2, PANEL, SPAN)
    output.place(path, lambda partial: sheet.save(partial, "PNG", optimize=True))


def _row(sheet, draw, top, pictures, region, numbers, exposure):
    truth = next(iter(pictures.values()))
    scale = (truth[region] @ LUMINANCE).mean()
    for k, ((caption, pixels), lines) in enumerate(zip(pictures.items(), numbers, strict=True)):
        left = MARGIN + k * (PANEL + GAP)
        draw.text((left, top), caption, picture.INK, picture.font(17))
        sheet.paste(_enlarged(picture.tone(pixels, exposure)), (left, top + 26))
        if k:
            apart = np.where(region, (pixels - truth) @ LUMINANCE / scale, np.nan)
            sheet.paste(_enlarged(picture.diverging(apart, SPAN)), (left, top + 26 + PANEL + GAP))
        for number, text in enumerate(lines):
            draw.text((left, top + 32 + 2 * PANEL + GAP + 20 * number), text, picture.FAINT, picture.font(14))


def _enlarged(pixels):
    return Image.fromarray(pixels).resize((PANEL, PANEL), Image.Resampling.NEAREST)

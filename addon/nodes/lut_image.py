# SPDX-License-Identifier: GPL-3.0-or-later
"""The LUT as a packed float32 image.

The height is rounded up to a power of two, so that every texel centre is exact in float32 and no
strip bleeds into its neighbour by rounding: weights of two strips may differ a thousandfold.
The strips of Eevee's closures follow those of the table, in blocks of as many strips, so that the
strip of a sheet's bottom side is as far above the strip of the top side as in the table.

The weight of a Principled BSDF below is one number for all colors. It is also the alpha of another strip,
which Cycles reads anyway: each texture less saves some per cent of the render time.

The table of the stack without the film of a varying interface lies above the first one in the same image.
"""

from dataclasses import dataclass

import numpy as np

from ..base import data_image
from ..kinds.table import PRINCIPLED, THROWN_BACK, Strip, strips_of


@dataclass(frozen=True)
class Table:
    """A lookup table in the image: `eevee`, lamina's RealTimeTable of `lut`; `first`: its lowest row of
    texels; `height`: of the image, a power of two."""

    lut: object
    eevee: object
    first: int
    height: int


def tables(lut, few_closures):
    """The Tables of the image of `lut`: its own, and that without the film, if it has one."""
    found, first = [], 0
    for one in (lut,) if lut.uncovered is None else (lut, lut.uncovered):
        eevee = few_closures(one)
        found.append((one, eevee, first))
        first += _rows(one, eevee)
    return [Table(*one, 1 << (first - 1).bit_length()) for one in found]


def eevee_strip(lut, number):
    """The place, in strips from the bottom, of strip `number` of Eevee's table (its top side)."""
    sides, count = np.shape(lut.weights)[:2]
    block, place = divmod(number, count)
    return sides * count * (1 + block) + place


def holder_of_principled(lut):
    """The strip whose alpha holds the weight of the Principled BSDF: one that is read at all values of the
    inputs."""
    strips, thrown_back = strips_of(lut.header), Strip(role=THROWN_BACK)
    return thrown_back if thrown_back in strips else next(strip for strip in strips if strip.closure)


def create(name, tables):
    """A new image without users, with all tables of a group."""
    texels = np.zeros((tables[0].height, np.shape(tables[0].lut.weights)[3], 4), dtype=np.float32)
    texels[:, :, 3] = 1.0
    for table in tables:
        _write(texels[table.first:], table.lut, table.eevee)
    return data_image.create(name, texels)


def _write(padded, lut, eevee):
    """`lut.image()` in the lower rows, and Eevee's strips above."""
    texels = np.ascontiguousarray(lut.image(), dtype=np.float32)
    count, rows = np.shape(lut.weights)[1:3]
    padded[:len(texels)] = texels
    own, principled = strips_of(lut.header), Strip(role=PRINCIPLED)
    if principled in own:
        first = own.index(holder_of_principled(lut)) * rows
        padded[first:first + rows, :, 3] = lut.weights[0, own.index(principled), ..., 0]
    for side, strips in enumerate(eevee.texels):
        for number, strip in enumerate(strips):
            first = (eevee_strip(lut, number) + side * count) * rows
            padded[first:first + rows] = strip


def _rows(lut, eevee):
    sides, count, rows = np.shape(lut.weights)[:3]
    blocks = 1 + -(-len(eevee.strips) // count)
    return sides * count * rows * blocks if sides > 1 else count * rows + len(eevee.strips) * rows

# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of a measured base: a text that JSON and .blend files hold, so a stack needs no other file.

The text is base64 of: VERSION; the number of channels, 1 or 3, one byte; by channel two 32-bit floats, the logarithms
that the steps 0 and 65535 stand for; by channel the steps, 16-bit integers [SHAPE]. All numbers are little-endian. What
the steps are is in native/core/matter/measured_reflection.hpp."""

from __future__ import annotations

import base64
import binascii
import functools
import math
import struct
from dataclasses import dataclass

from .errors import StackError, quoted

SHAPE = (64, 24, 17)  # knots in the tilt of the half vector, in the angle from it, in the turn about it
VERSION = b"LMB1"
STEPS = 65535
LARGEST_LOG = 50.0
_SIZE = 2 * math.prod(SHAPE)


@dataclass(frozen=True)
class TableText:
    """The description of the member that holds the text, in place of an Option."""

    name: str
    label: str
    tip: str

    usual = None
    several = False

    @staticmethod
    def plain(value: str) -> str:
        """JSON form."""
        return value

    def check(self, value, path: str) -> str:
        """The text. Raises StackError unless it is a table."""
        if not value:
            raise StackError(f"{path} is missing: must be read from a .binary file of MERL or a .bsdf file of RGL "
                             "(lamina.measurements.load_base)")
        if not isinstance(value, str):
            raise StackError(f"{path} = {quoted(value)}: must be a text that lamina.measurements.load_base made")
        try:
            table_of(value)
        except ValueError as reason:
            raise StackError(f"{path}: {reason}; must be a text that lamina.measurements.load_base made") from None
        return value


def text_of(channels: list[tuple[float, float, bytes]]) -> str:
    """The text of a table: by channel the logarithms of the first and the last step, and the steps."""
    head = VERSION + bytes([len(channels)]) + b"".join(struct.pack("<ff", low, high) for low, high, _ in channels)
    return base64.b64encode(head + b"".join(steps for *_, steps in channels)).decode()


@functools.lru_cache(maxsize=8)
def table_of(text: str) -> tuple[tuple[float, float, bytes], ...]:
    """What text_of was given. Raises ValueError, with the reason."""
    try:
        data = base64.b64decode(text.encode(), validate=True)
    except (binascii.Error, UnicodeEncodeError):
        raise ValueError("not a table of a measured material") from None
    if data[:3] != VERSION[:3]:
        raise ValueError("not a table of a measured material")
    if data[:4] != VERSION:
        raise ValueError("a table of a newer Lamina")
    count = data[4] if len(data) > 4 else 0
    first = 5 + 8 * count
    if count not in (1, 3) or len(data) != first + count * _SIZE:
        raise ValueError("a truncated table")
    ends = [struct.unpack_from("<ff", data, 5 + 8 * k) for k in range(count)]
    if not all(-LARGEST_LOG <= low <= high <= LARGEST_LOG for low, high in ends):
        raise ValueError("a table with values out of range")
    return tuple((*ends[k], data[first + k * _SIZE:first + (k + 1) * _SIZE]) for k in range(count))

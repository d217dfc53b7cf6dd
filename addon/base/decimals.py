# SPDX-License-Identifier: GPL-3.0-or-later
"""Short decimals of float32 numbers. Blender stores .9 as the float32 0.89999998, which must be read back as
.9."""

import functools
import struct


@functools.lru_cache(4096)
def shortest(value):
    """The decimal with the fewest digits that is the same float32 as `value`."""
    single = struct.pack("f", value)
    for digits in range(1, 10):
        text = f"{value:.{digits}g}"
        if struct.pack("f", float(text)) == single:
            return float(text)
    return value


def same(left, right):
    """True if two lists of numbers are equal as float32."""
    return len(left) == len(right) and all(
        struct.pack("f", one) == struct.pack("f", other) for one, other in zip(left, right, strict=True)
    )

# SPDX-License-Identifier: GPL-3.0-or-later
"""The tensor files of RGL (.bsdf), version 1.0: a table of named arrays, then the arrays, little-endian."""

from __future__ import annotations

import math
import os
import struct
from typing import BinaryIO

import numpy as np

from .arguments import check_path

_MAGIC = b"tensor_file\0"
# Types by their numbers in the file.
_TYPES = {1: "u1", 2: "i1", 3: "<u2", 4: "<i2", 5: "<u4", 6: "<i4", 7: "<u8", 8: "<i8", 9: "<f2", 10: "<f4", 11: "<f8"}
_MOST_FIELDS, _MOST_AXES = 64, 8


class NoTensors(Exception):  # noqa: N818 - callers raise their own error with a description of the file
    """The file is not a complete tensor file; str() gives the reason."""


def write_tensors(file: BinaryIO, fields: dict[str, np.ndarray]) -> None:
    """Writes arrays by name: uint8 as it is, all others as float32."""
    arrays = {name: np.ascontiguousarray(value, None if value.dtype == np.uint8 else "<f4")
              for name, value in fields.items()}
    entries = {name: (name.encode(), array) for name, array in arrays.items()}
    position = 18 + sum(2 + len(label) + 2 + 1 + 8 + 8 * array.ndim for label, array in entries.values())
    places = []
    file.write(_MAGIC + struct.pack("<BBI", 1, 0, len(entries)))
    for label, array in entries.values():
        position += -position % 8
        places.append(position)
        file.write(struct.pack("<H", len(label)) + label)
        number = 1 if array.dtype == np.uint8 else 10
        file.write(struct.pack(f"<HBQ{array.ndim}Q", array.ndim, number, position, *array.shape))
        position += array.nbytes
    for place, (_, array) in zip(places, entries.values(), strict=True):
        file.write(bytes(place - file.tell()))
        file.write(array.tobytes())


def read_tensors(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """The arrays of a file by name. Raises NoTensors, and OSError when the file cannot be opened."""
    data = check_path(path).read_bytes()
    if not data.startswith(_MAGIC):
        raise NoTensors("no tensor file")
    try:
        major, _, count = struct.unpack_from("<BBI", data, len(_MAGIC))
        if major != 1 or count > _MOST_FIELDS:
            raise NoTensors(f"a tensor file of version {major} with {count} arrays")
        at, fields = 18, {}
        for _ in range(count):
            (length,) = struct.unpack_from("<H", data, at)
            name = data[at + 2:at + 2 + length].decode()
            axes, number, place = struct.unpack_from("<HBQ", data, at + 2 + length)
            if axes > _MOST_AXES or number not in _TYPES:
                raise NoTensors("an array has an unknown type")
            shape = struct.unpack_from(f"<{axes}Q", data, at + 13 + length)
            at += 13 + length + 8 * axes
            fields[name] = np.frombuffer(data, _TYPES[number], math.prod(shape), place).reshape(shape)
    except (struct.error, ValueError, UnicodeDecodeError, OverflowError):
        raise NoTensors("the file is truncated or damaged") from None
    return fields

# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives (.npz) of arrays and a JSON header. Equal content gives equal bytes."""

from __future__ import annotations

import json
import math
import os
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from . import json_file
from .atomic import write_atomically

# Exceptions from reading a damaged or foreign archive.
_DAMAGE = (ValueError, KeyError, EOFError, OSError, TypeError, AttributeError, RuntimeError, RecursionError,
           NotImplementedError, zipfile.BadZipFile, zlib.error)


class Damaged(Exception):  # noqa: N818 - callers raise their own error with a description of the file
    """The file is not a complete archive of these arrays."""


def save_archive(path, header: dict, **arrays: np.ndarray) -> None:
    """Writes an .npz file, completely or not at all. Unlike numpy.savez, equal content gives equal bytes. The header is
    stored as JSON in an array of bytes. Raises OSError."""
    text = np.frombuffer(json.dumps(header, sort_keys=True).encode(), np.uint8)
    write_atomically(path, lambda file: _write(file, {"header": text, **arrays}))


def _write(file, arrays: dict[str, np.ndarray]) -> None:
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            with archive.open(entry, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.ascontiguousarray(array), allow_pickle=False)


def load_archive(path, *names: str) -> tuple[Any, list[np.ndarray]]:
    """(header, arrays by these names) of an .npz file. Raises Damaged, and OSError when it cannot be opened."""
    with Path(path).open("rb") as file:
        try:
            if file.read(2) != b"PK":  # zipfile would skip bytes before the archive
                raise ValueError("not an archive from its start")
            with zipfile.ZipFile(file) as archive:
                header = json_file.parse(bytes(_read(archive, "header", file)))
                return header, [_read(archive, name, file) for name in names]
        except _DAMAGE:
            raise Damaged(str(path)) from None


def _read(archive: zipfile.ZipFile, name: str, file) -> np.ndarray:
    """One array. Its shape is compared with the size of the file before memory is allocated; numpy.load would allocate
    first. Raises one of _DAMAGE."""
    entry = archive.getinfo(f"{name}.npy")
    if entry.compress_type != zipfile.ZIP_STORED or entry.file_size > os.fstat(file.fileno()).st_size:
        raise ValueError("not stored as it is")
    with archive.open(entry) as member:
        shape, by_column, dtype = _shape_of(member)
        size = entry.file_size - member.tell()
        if dtype.hasobject or min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != size:
            raise ValueError("the shape does not fit the file")
        content = bytearray(member.read())
    return np.frombuffer(content, dtype).reshape(shape, order="F" if by_column else "C")


def _shape_of(member) -> tuple:
    """(shape, whether it is stored by columns, dtype) from the start of a .npy file. Raises one of _DAMAGE."""
    version = np.lib.format.read_magic(member)
    read_header = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    try:
        return read_header[version](member)
    except (SyntaxError, tokenize.TokenError, MemoryError):  # Python's parser, given something other than a literal
        raise ValueError("the header is no literal") from None

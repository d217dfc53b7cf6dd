# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives (.npz) of arrays and a JSON header. Equal content gives equal bytes."""

from __future__ import annotations

import json
import math
import os
import tokenize
import zipfile
import zlib
from typing import Any

import numpy as np

from . import json_file
from .arguments import check_path
from .atomic import write_atomically
from .errors import clipped

# Exceptions from reading a damaged or foreign archive.
_DAMAGE = (ValueError, KeyError, EOFError, OSError, TypeError, AttributeError, RuntimeError, RecursionError,
           NotImplementedError, zipfile.BadZipFile, zlib.error)


class Damaged(Exception):  # noqa: N818 - callers raise their own error with a description of the file
    """The file is not a complete archive of these arrays; str() gives the reason."""


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
    with check_path(path).open("rb") as file:
        if file.read(2) != b"PK":  # zipfile would skip bytes before the archive
            raise Damaged("no .npz archive")
        try:
            with zipfile.ZipFile(file) as archive:
                content = bytes(_read(archive, "header", file))
                try:
                    header = json_file.parse(content)
                except ValueError as error:
                    raise Damaged(f"its header is not valid JSON, {clipped(str(error))}") from None
                return header, [_read(archive, name, file) for name in names]
        except _DAMAGE:
            raise Damaged("the archive is truncated or damaged") from None


def _read(archive: zipfile.ZipFile, name: str, file) -> np.ndarray:
    """One array. Its shape is compared with the size of the file before memory is allocated; numpy.load would allocate
    first. Raises Damaged, or one of _DAMAGE."""
    try:
        entry = archive.getinfo(f"{name}.npy")
    except KeyError:
        raise Damaged(f"it has no array {name!r}") from None
    if entry.compress_type != zipfile.ZIP_STORED:
        raise Damaged(f"its array {name!r} is compressed")
    if entry.file_size > os.fstat(file.fileno()).st_size:
        raise Damaged(f"its array {name!r} is larger than the file")
    with archive.open(entry) as member:
        try:
            shape, by_column, dtype = _shape_of(member)
        except _DAMAGE:
            raise Damaged(f"its array {name!r} has no description that NumPy reads") from None
        size = entry.file_size - member.tell()
        if dtype.hasobject:
            raise Damaged(f"its array {name!r} holds Python objects")
        if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != size:
            raise Damaged(f"its array {name!r} has {size} bytes, which do not fit the shape {clipped(str(shape))}")
        try:
            content = bytearray(member.read())
        except zipfile.BadZipFile:
            raise Damaged(f"the checksum of its array {name!r} is wrong") from None
    return np.frombuffer(content, dtype).reshape(shape, order="F" if by_column else "C")


def _shape_of(member) -> tuple:
    """(shape, whether it is stored by columns, dtype) from the start of a .npy file. Raises one of _DAMAGE."""
    version = np.lib.format.read_magic(member)
    read_header = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    try:
        return read_header[version](member)
    except (SyntaxError, tokenize.TokenError, MemoryError):  # Python's parser, given something other than a literal
        raise ValueError("the header is no literal") from None

# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from PLY files (Turk 1994): ASCII and binary of either byte order; triangles, and larger faces as fans."""

from __future__ import annotations

import codecs
import gzip
import os
import warnings
import zlib
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_path
from ..common.errors import MeshFileError, clipped
from .mesh import Mesh

_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
          "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
          "double": "f8", "float64": "f8"}
_FORMATS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
_CORNERS = ("vertex_indices", "vertex_index", "indices")  # names in use for the list of a face's vertices
_MOST = 1 << 30
_LONGEST = 1 << 20  # header, bytes


@dataclass
class _Element:
    """name, count, and properties as (name, type, type of a list's length or None)."""

    name: str
    count: int
    properties: list


def load(path: str | os.PathLike) -> Mesh:
    """The mesh of a .ply or .ply.gz file, neither turned nor scaled. Faces of n corners become n - 2 triangles; those
    with fewer than three are ignored. Any line ends are accepted. Raises MeshFileError, OSError."""
    path = check_path(path)
    data = path.read_bytes()
    if data[:2] == b"\x1f\x8b":
        try:
            data = gzip.decompress(data)
        except (OSError, EOFError, zlib.error) as error:
            raise MeshFileError(f"{path}: is a damaged gzip file ({error})") from None
    try:
        order, elements, body = _header(data)
        read = _Ascii(body) if order is None else _Binary(body, order)
        columns, faces = {}, (np.zeros(0, np.int64), np.zeros(0, np.int64))
        for element in elements:
            if element.name == "face":
                faces = read.lists(element, _CORNERS)
            elif element.name == "vertex":
                columns = read.numbers(element, ("x", "y", "z"))
            elif element.properties:
                read.skip(element)
    except _BadFileError as error:
        raise MeshFileError(f"{path}: {error}") from None
    except (ValueError, IndexError, OverflowError):
        raise MeshFileError(f"{path}: is not a complete PLY file") from None
    if not columns:
        raise MeshFileError(f"{path}: has no vertices")
    vertices = np.column_stack([columns[name] for name in "xyz"]).astype(np.float64)
    triangles = _fans(*faces)
    if len(triangles) and not (triangles.min() >= 0 and triangles.max() < len(vertices)):
        raise MeshFileError(f"{path}: a face has an index outside [0, {len(vertices) - 1}]")
    return Mesh(vertices, triangles, name=path.name)


class _BadFileError(Exception):
    """Holds the rest of a sentence that begins with the path."""


def _header(data: bytes) -> tuple[str | None, list[_Element], bytes]:
    """(byte order or None for ASCII, elements, the bytes after the header)."""
    data = data.removeprefix(codecs.BOM_UTF8)
    if data[:3] != b"ply":
        raise _BadFileError("is not a PLY file")
    # The first line determines the line end of the header. After the header, such a byte may be part of a binary
    # number.
    end = b"\r\n" if data[3:5] == b"\r\n" else data[3:4]
    if end not in (b"\n", b"\r", b"\r\n"):
        end = b"\n"
    lines: list[str] = []
    start = 0
    while not lines or lines[-1].split() != ["end_header"]:
        last = data.find(end, start, start + _LONGEST)
        if last < 0 or last > _LONGEST:
            raise _BadFileError("is not a PLY file, as its header has no end")
        lines.append(data[start:last].decode("ascii", "replace"))
        start = last + len(end)
    order: str | None = ""
    elements: list[_Element] = []
    for line in lines[1:-1]:
        words = line.split()
        if not words or words[0] in ("comment", "obj_info"):
            continue
        if words[0] == "format" and len(words) == 3 and words[1] in _FORMATS:
            order = _FORMATS[words[1]]
        elif words[0] == "element" and len(words) == 3 and words[2].isdecimal():
            if len(words[2]) > len(str(_MOST)) or int(words[2]) > _MOST:
                raise _BadFileError(f"has {clipped(words[2])} elements {clipped(words[1])!r}: must have at most "
                                    f"{_MOST}")
            if any(element.name == words[1] for element in elements):
                raise _BadFileError(f"has two elements {words[1][:60]!r}")
            elements.append(_Element(words[1], int(words[2]), []))
        elif words[0] == "property" and elements and len(words) == 3 and words[1] in _TYPES:
            elements[-1].properties.append((words[2], _TYPES[words[1]], None))
        elif words[0] == "property" and elements and len(words) == 5 and words[1] == "list" and \
                words[2] in _TYPES and words[3] in _TYPES:
            elements[-1].properties.append((words[4], _TYPES[words[3]], _TYPES[words[2]]))
        else:
            raise _BadFileError(f"has a header line that is not understood: {line.strip()[:60]!r}")
    if order == "":
        raise _BadFileError("has no format line")
    return order, elements, data[start:]


class _Binary:
    def __init__(self, body: bytes, order: str):
        self._body, self._order, self._at = body, order, 0

    def numbers(self, element: _Element, wanted: tuple[str, ...]) -> dict:
        _require(element, wanted)
        kinds = [(f"p{i}", self._order + kind) for i, (_, kind, _) in enumerate(element.properties)]
        rows = self._take(np.dtype(kinds), element.count)
        return {name: rows[f"p{i}"] for i, (name, _, _) in enumerate(element.properties) if name in wanted}

    def lists(self, element: _Element, wanted: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        """(lengths, all items in sequence) of the wanted list property."""
        _list_of(element, wanted)
        # Most files hold faces of one size: read them as a table, and check that all sizes are equal.
        start = self._at
        for size in (3, 4):
            table = self._table(element, size)
            if table is None:
                continue
            lists = [(i, length) for i, (_, _, length) in enumerate(element.properties) if length]
            if all((table[f"n{i}"] == size).all() for i, _ in lists):
                place = next(i for i, (name, _, _) in enumerate(element.properties) if name in wanted)
                return np.full(element.count, size), table[f"p{place}"].astype(np.int64).ravel()
            self._at = start
        return self._mixed(element, wanted)

    def skip(self, element: _Element) -> None:
        if any(length for _, _, length in element.properties):
            self._mixed(element, ())
        else:
            self._take(np.dtype([(f"p{i}", self._order + k) for i, (_, k, _) in enumerate(element.properties)]),
                       element.count)

    def _table(self, element: _Element, size: int):
        kinds: list[tuple] = []
        for i, (_, kind, length) in enumerate(element.properties):
            kinds += [(f"n{i}", self._order + length), (f"p{i}", self._order + kind, (size,))] if length else [
                (f"p{i}", self._order + kind)]
        kind = np.dtype(kinds)
        return self._take(kind, element.count) if self._at + kind.itemsize * element.count <= len(self._body) else None

    def _mixed(self, element: _Element, wanted) -> tuple[np.ndarray, np.ndarray]:
        lengths, items = [], []
        for _ in range(element.count):
            for name, kind, length in element.properties:
                count = int(self._take(np.dtype(self._order + length), 1)[0]) if length else 1
                if count < 0:
                    raise _BadFileError("has a list of negative length")
                row = self._take(np.dtype(self._order + kind), count)
                if name in wanted:
                    lengths.append(count)
                    items.append(row)
        return np.array(lengths, np.int64), np.concatenate([*items, np.zeros(0)]).astype(np.int64)

    def _take(self, kind: np.dtype, count: int) -> np.ndarray:
        if self._at + kind.itemsize * count > len(self._body):
            raise _BadFileError("ends too early")
        rows = np.frombuffer(self._body, kind, count, self._at)
        self._at += kind.itemsize * count
        return rows


class _Ascii:
    def __init__(self, body: bytes):
        # Convert all words to numbers at once: positions are counted in words, independent of lines.
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # fromstring only warns about invalid words
            try:
                self._words = np.fromstring(body.decode("ascii"), dtype=np.float64, sep=" ")
            except (ValueError, DeprecationWarning):
                raise _BadFileError("holds a word that is not a number") from None
        self._at = 0

    def numbers(self, element: _Element, wanted: tuple[str, ...]) -> dict:
        _require(element, wanted)
        width = len(element.properties)
        rows = self._take(width * element.count).reshape(element.count, width)
        return {name: rows[:, i] for i, (name, _, _) in enumerate(element.properties) if name in wanted}

    def lists(self, element: _Element, wanted: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        _list_of(element, wanted)
        if len(element.properties) == 1 and element.count:
            for size in (3, 4):
                end = self._at + (size + 1) * element.count
                table = self._words[self._at:end]
                if end <= len(self._words) and (table[::size + 1] == size).all():
                    self._at = end
                    rows = table.reshape(element.count, size + 1)[:, 1:]
                    return np.full(element.count, size), rows.astype(np.int64).ravel()
        return self._mixed(element, wanted)

    def skip(self, element: _Element) -> None:
        self._mixed(element, ())

    def _mixed(self, element: _Element, wanted) -> tuple[np.ndarray, np.ndarray]:
        lengths, items = [], []
        for _ in range(element.count):
            for name, _, length in element.properties:
                count = int(self._take(1)[0]) if length else 1
                if count < 0:
                    raise _BadFileError("has a list of negative length")
                row = self._take(count)
                if name in wanted:
                    lengths.append(count)
                    items.append(row)
        return np.array(lengths, np.int64), np.concatenate([*items, np.zeros(0)]).astype(np.int64)

    def _take(self, count: int) -> np.ndarray:
        if self._at + count > len(self._words):
            raise _BadFileError("ends too early")
        self._at += count
        return self._words[self._at - count:self._at]


def _require(element: _Element, wanted: tuple[str, ...]) -> None:
    names = [name for name, _, length in element.properties if length is None]
    missing = [name for name in wanted if name not in names]
    if missing or len(names) < len(element.properties):
        raise _BadFileError(f"its element {element.name} has no number {missing[0]}" if missing else
                            f"its element {element.name} holds a list")


def _list_of(element: _Element, wanted: tuple[str, ...]) -> None:
    if not any(name in wanted and length for name, _, length in element.properties):
        raise _BadFileError(f"its element {element.name} has no list {wanted[0]}")


def _fans(lengths: np.ndarray, items: np.ndarray) -> np.ndarray:
    """(m, 3) triangles of faces, given by the lengths and the corners of all faces in sequence."""
    starts = np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.int64) if len(lengths) else lengths
    counts = np.maximum(lengths - 2, 0)
    first = np.repeat(starts, counts)
    place = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.column_stack([items[first], items[first + place + 1], items[first + place + 2]]).reshape(-1, 3)

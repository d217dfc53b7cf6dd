# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives of arrays (.npz) beside a JSON header, whose bytes depend on nothing but their content."""

from __future__ import annotations

import json
import zipfile
import zlib
from pathlib import Path

import numpy as np

from .atomic import write_atomically

# What reading a damaged archive, or one of something else, may raise.
_DAMAGE = (ValueError, KeyError, EOFError, OSError, TypeError, AttributeError, RuntimeError, RecursionError,
           NotImplementedError, zipfile.BadZipFile, zlib.error)


class Damaged(Exception):  # noqa: N818 - callers say in their own words what file it is
    """The file is no whole archive with these arrays."""


def save_archive(path, header: dict, **arrays: np.ndarray) -> None:
    """Writes an .npz file, whole or not at all: like numpy.savez, but equal contents are equal bytes. The
    header is JSON, held as bytes. Raises OSError."""
    text = np.frombuffer(json.dumps(header, sort_keys=True).encode(), np.uint8)
    write_atomically(path, lambda file: _write(file, {"header": text, **arrays}))


def _write(file, arrays: dict[str, np.ndarray]) -> None:
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            with archive.open(entry, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.ascontiguousarray(array), allow_pickle=False)


def load_archive(path, *names: str) -> tuple[object, list[np.ndarray]]:
    """(header, arrays by these names) of an .npz file. Raises Damaged, and OSError when it cannot be opened."""
    with Path(path).open("rb") as file:
        try:
            with np.load(file, allow_pickle=False) as archive:
                return json.loads(bytes(archive["header"])), [archive[name] for name in names]
        except _DAMAGE:
            raise Damaged(str(path)) from None

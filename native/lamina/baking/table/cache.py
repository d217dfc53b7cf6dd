# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of finished lookup tables. Several processes and machines may share the folder."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from ... import _core
from ...common.atomic import remove_forgotten
from ...common.errors import LutError
from ...material.stack import Stack
from .lut import Lut


class LutCache:
    """One file for each stack, quality, basis and version of Lamina, written completely or not at all. A damaged file
    counts as missing. The folder is made by `save` and by `check_writable`."""

    def __init__(self, folder: str | os.PathLike):
        self.folder = Path(folder)

    def check_writable(self) -> None:
        """Raises OSError if no file can be written to the folder."""
        self.folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=self.folder):
            pass

    def path(self, stack_hash: str, quality: str, basis: str) -> Path:
        """Where the table of this version is kept."""
        return self.folder / f"{stack_hash}-{quality}-{basis}-{_core.__version__}.npz"

    def load(self, stack: Stack, quality: str, basis: str) -> Lut | None:
        """The table, or None."""
        path = self.path(stack.hash, quality, basis)
        try:
            lut = Lut.load(path)
        except (OSError, LutError):
            return None
        header = lut.header
        wanted = {"stack_hash": stack.hash, "quality": quality, "basis": basis, "version": _core.__version__}
        if any(header.get(name) != value for name, value in wanted.items()):
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return lut

    def save(self, lut: Lut) -> None:
        """Keeps a table. Raises OSError."""
        header = lut.header
        self.folder.mkdir(parents=True, exist_ok=True)
        lut.save(self.path(header["stack_hash"], header["quality"], header["basis"]))

    def remove_forgotten(self) -> None:
        """Removes the temporary files of killed processes."""
        remove_forgotten(self.folder, ".*.npz.*.part")

    def prune(self, most_bytes: int) -> None:
        """Removes tables until they take at most `most_bytes`, starting with those that were not used for longest.
        Files of other names are left alone."""
        found = []
        for path in self.folder.glob("*-*-*-*.npz"):
            with contextlib.suppress(OSError):
                status = path.stat()
                found.append((status.st_mtime_ns, status.st_size, path))
        total = sum(size for _, size, _ in found)
        for _, size, path in sorted(found):
            if total <= most_bytes:
                break
            with contextlib.suppress(OSError):
                path.unlink()
            total -= size

# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written completely or not at all."""

from __future__ import annotations

import contextlib
import errno
import glob
import os
import stat
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from .arguments import check_path

FORGOTTEN = 3600.0  # seconds since the last write after which the process that wrote a temporary file is taken for dead


def write_atomically(path: str | os.PathLike, write: Callable[[BinaryIO], object]) -> None:
    """Calls `write` with a temporary file beside `path`, and renames this file to `path` when all is written.

    A symbolic link stays, and its target is written. After any failure or interruption the earlier file is unchanged;
    a kill leaves the temporary file, which a later save of the same file removes. Raises ArgumentError for a path that
    cannot name a file; OSError, with the name of the target, for devices, pipes, sockets and folders, which are left
    alone, and where writing fails."""
    target = _target(path)
    try:
        _refuse_special(target)
        remove_forgotten(target.parent, _pattern(target))
        _replace(target, write)
    except OSError as error:
        # Errors of the temporary file would show its name, and errors of a full disk show none.
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error


def remove_forgotten(folder: Path, pattern: str) -> None:
    """Removes the temporary files of killed processes, by a pattern of glob."""
    for path in folder.glob(pattern):
        with contextlib.suppress(OSError):
            if time.time() - path.stat().st_mtime > FORGOTTEN:
                path.unlink()


def _target(path: str | os.PathLike) -> Path:
    """The file that `path` names, with symbolic links followed. Raises ArgumentError."""
    return Path(os.path.realpath(check_path(path)))


def _refuse_special(target: Path) -> None:
    """Raises OSError if something other than an ordinary file is there."""
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        return
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "not an ordinary file, but a device, pipe or socket")


def _pattern(target: Path) -> str:
    return f".{glob.escape(target.name)}.*.part"


def _replace(target: Path, write: Callable[[BinaryIO], object]) -> None:
    descriptor, temporary = tempfile.mkstemp(prefix=f".{target.name}.", suffix=".part", dir=target.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes files that only their owner can read; set the mode that open() would have set.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, target)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise

# SPDX-License-Identifier: GPL-3.0-or-later
"""Saving a .blend after a long bake without loss of other people's work.

Before the bake, the code checks whether the file can be written. A file that has changed meanwhile is not
overwritten: the bake is then saved under another name.
"""

import os
import shutil
import tempfile
from pathlib import Path

import bpy
from bpy.app.handlers import persistent

from ..base import handlers, messages
from .file_lock import SaveError

PROBE = 1 << 16  # bytes that must fit into a folder

_stamps = {}  # real path -> the file's stamp when it was last read or written here


class Saving:
    """The save of the open file to `target`, a Path, after a bake. Made when the file has been opened, before
    the bake."""

    def __init__(self, target):
        self.target = target
        self._is_open_file = bool(bpy.data.filepath) and _real(bpy.data.filepath) == _real(target)
        self._expected = _stamps.get(_real(target)) if self._is_open_file else None
        self._expected = self._expected or _stamp(target)

    def check_space(self, growth):
        """Raises SaveError if the disk has no room for the open file and `growth` more bytes."""
        problem = _full(self.target, _bytes_before() + growth)
        if problem:
            raise SaveError(f"{self.target} cannot be saved: {problem}")

    def save(self):
        """Save the open file. Raises SaveError when that fails, and when the target has changed since it was
        opened, or since the start of the bake: then the file is saved beside the target."""
        now = _stamp(self.target)
        if now is not None and now != self._expected:
            aside = _free_name(self.target)
            _write(aside, copy=True)
            since = "it was opened" if self._is_open_file else "the bake began"
            raise SaveError(f"{self.target} has been changed by another program since {since}, and was left "
                            f"alone: this bake is saved as {aside}")
        _write(self.target, copy=False)


def check_writable(target):
    """Raises SaveError if no file can be written there."""
    problem = _unwritable(target)
    if problem:
        raise SaveError(f"{target} cannot be saved: {problem}")


def _unwritable(target):
    """The reason why the target cannot be written, or ''."""
    if target.is_dir():
        return "it is a folder"
    if target.exists() and not os.access(target, os.W_OK):
        return "the file is read-only"
    try:
        with tempfile.TemporaryFile(dir=target.parent) as probe:
            probe.write(bytes(PROBE))
            probe.flush()
            os.fsync(probe.fileno())
    except OSError as error:
        return f"{target.parent}: {error.strerror}"
    return ""


def _full(target, needed):
    """The sentence about a disk without room for `needed` bytes, or ''. Blender writes a complete new file
    before it removes the old one."""
    free = shutil.disk_usage(target.parent).free
    if free < needed:
        amounts = f"{_megabytes(free)} free, about {_megabytes(needed)} needed"
        return f"the disk of {target.parent} is full, {amounts}"
    return ""


def _bytes_before():
    """The size of the open file on disk; with a new bake the file will hardly be smaller."""
    opened = Path(bpy.data.filepath) if bpy.data.filepath else None
    return opened.stat().st_size if opened is not None and opened.is_file() else 0


def _bytes_now():
    """About how large the open file would be: as large as before, and no smaller than the packed images."""
    packed = [image.packed_file for image in bpy.data.images if image.packed_file is not None]
    return max(_bytes_before(), sum(file.size for file in packed))


def _megabytes(count):
    return f"{count / 1e6:.1f} MB"


def _write(path, copy):
    """Save the open file; `copy`: under another name, while it keeps its own. Raises SaveError."""
    try:
        result = _save_by_blender(path, copy)
        words = "" if "FINISHED" in result else "Blender cancelled"
    except RuntimeError as error:
        words = messages.reported(error) or "Blender names no reason"
    if words:
        # Blender reads errno too late: on a full disk it says "Success".
        free = f"Blender names no reason, {_megabytes(shutil.disk_usage(path.parent).free)} are free"
        reason = _unwritable(path) or _full(path, _bytes_now()) or (free if words == "Success" else words)
        raise SaveError(f"{path} could not be saved: {reason}")


def _save_by_blender(path, copy):
    # A file opened through a symbolic link is saved by its real name: Blender would replace the link.
    if not copy and bpy.data.filepath == str(path):
        return bpy.ops.wm.save_mainfile()
    return bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False, copy=copy)


def _free_name(target):
    """A name beside the target that no file has yet."""
    number = 1
    while True:
        path = target.with_name(f"{target.stem}.lamina-{number}.blend")
        if not path.exists():
            return path
        number += 1


def _real(path):
    return os.path.realpath(path)


def _stamp(path):
    """A value that changes whenever a file is written; None without a file."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def _note(path):
    if path:
        _stamps[_real(path)] = _stamp(path)


@persistent
def _before_load(path, *_):
    _note(path)


@persistent
def _after_save(path, *_):
    _note(path)


HANDLERS = {"load_pre": _before_load, "save_post": _after_save}


def register():
    handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
    _stamps.clear()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Saving a .blend after a long bake without loss of other people's work.

Before the bake, the code checks whether the file can be written. During the bake, a lock file beside the
.blend keeps other bakes of the same file away. A file that has changed meanwhile is not overwritten: the bake
is then saved under another name.
"""

import json
import os
import shutil
import socket
import tempfile
from pathlib import Path

import bpy
from bpy.app.handlers import persistent

from ..base import messages

PROBE = 1 << 16  # bytes that must fit into a folder

_stamps = {}  # real path -> the file's stamp when it was last read or written here


class SaveError(messages.RefusedError):
    """Nothing was saved in the requested place; str() is one sentence with the reason."""


class Saving:
    """A context around a bake whose result is saved to `target`, a Path; the lock file exists inside `with`.

    Entering raises SaveError when the target cannot be written, or is being baked by another process.
    """

    def __init__(self, target):
        self.target = target
        self._lock = target.with_name(f".{target.name}.lamina-lock")
        self._is_open_file = bool(bpy.data.filepath) and _real(bpy.data.filepath) == _real(target)
        self._expected = _stamps.get(_real(target)) if self._is_open_file else None
        self._expected = self._expected or _stamp(target)

    def __enter__(self):
        problem = _problem(self.target, _bytes_before())
        if problem:
            raise SaveError(f"{self.target} cannot be saved: {problem}")
        self._take_lock()
        return self

    def __exit__(self, *_):
        self._lock.unlink(missing_ok=True)

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

    def _take_lock(self):
        try:
            if not self._create_lock():
                owner = self._owner()
                if not _has_ended(owner):
                    raise SaveError(f"{self.target} is being baked by {_words(owner)}: wait for its end, "
                                    f"or delete {self._lock} if there is no such process")
                self._lock.unlink(missing_ok=True)
                if not self._create_lock():
                    owner = self._owner()
                    raise SaveError(f"{self.target} is being baked by {_words(owner)}: wait for its end")
        except OSError as error:
            raise SaveError(f"{self.target} cannot be saved: {error.strerror}") from error

    def _create_lock(self):
        """Creates the lock file. Returns False if it exists already."""
        try:
            descriptor = os.open(self._lock, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644)
        except FileExistsError:
            return False
        with os.fdopen(descriptor, "w", encoding="utf-8") as file:
            json.dump({"pid": os.getpid(), "host": socket.gethostname()}, file)
        return True

    def _owner(self):
        """(process id, host) of the lock's owner; None for unknown parts."""
        try:
            owner = json.loads(self._lock.read_text(encoding="utf-8"))
            return int(owner["pid"]), str(owner["host"])
        except (OSError, ValueError, KeyError, TypeError):
            return None, None


def _has_ended(owner):
    """True if the process has certainly ended: it ran on this machine, and does not exist any more."""
    pid, host = owner
    if pid is None or host != socket.gethostname() or os.name == "nt":  # there, signal 0 is Ctrl-C
        return False
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return False


def _words(owner):
    pid, host = owner
    return "another process" if pid is None else f"process {pid} on {host}"


def _problem(target, needed):
    """The reason why `needed` bytes cannot be written to the target, or ''. Blender writes a complete new
    file before it removes the old one."""
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
        words = " ".join(str(error).split()).removeprefix("Error: ") or "Blender names no reason"
    if words:
        # Blender reads errno too late: on a full disk it says "Success".
        free = f"Blender names no reason, {_megabytes(shutil.disk_usage(path.parent).free)} are free"
        reason = _problem(path, _bytes_now()) or (free if words == "Success" else words)
        raise SaveError(f"{path} could not be saved: {reason}")


def _save_by_blender(path, copy):
    if not copy and bpy.data.filepath and _real(bpy.data.filepath) == _real(path):
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
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in HANDLERS.items():
        if handler in getattr(bpy.app.handlers, name):
            getattr(bpy.app.handlers, name).remove(handler)
    _stamps.clear()

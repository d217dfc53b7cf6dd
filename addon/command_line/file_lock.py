# SPDX-License-Identifier: GPL-3.0-or-later
"""A lock file beside a .blend, which keeps other bakes of the same file away.

The file names its owner. On top of that, the operating system locks the file while the owner lives: after a
kill the next bake takes the lock over at once. Such locks may not reach other machines of a network, so an
owner on another machine is believed.
"""

import contextlib
import errno
import json
import os
import socket
import time

from ..base import messages

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None
    import msvcrt

TRIES, PAUSE = 10, 0.05  # for the moment between the creation of a lock file and its owner's name
PLACE = 1 << 20  # Windows locks bytes, and a locked byte cannot be read: one that the file does not have


class SaveError(messages.RefusedError):
    """Nothing was saved in the requested place; str() is one sentence with the reason."""


class FileLock:
    """A context that holds the lock of `target`, a Path. Entering raises SaveError if another process has it,
    or if the lock file cannot be written."""

    def __init__(self, target):
        self._target = target
        self._path = target.with_name(f".{target.name}.lamina-lock")
        self._descriptor = None

    def __enter__(self):
        try:
            for number in range(TRIES):
                if self._take(is_last=number == TRIES - 1):
                    return self
                time.sleep(PAUSE)
        except OSError as error:
            raise SaveError(f"{self._target} cannot be saved: {error.strerror}") from error
        raise self._busy((None, None))

    def __exit__(self, *_):
        if fcntl is None:  # Windows does not remove an open file
            os.close(self._descriptor)
        with contextlib.suppress(OSError):
            self._path.unlink(missing_ok=True)
        if fcntl is not None:
            os.close(self._descriptor)

    def _take(self, is_last):
        """Returns False if the lock file is just being made or removed. Raises SaveError, OSError."""
        descriptor, is_new = self._open()
        try:
            is_locked = descriptor is not None and _lock(descriptor)
            owner = None if descriptor is None or is_new else _owner(descriptor)
            if (
                owner is not None
                and not (is_locked and _has_ended(owner))
                and (owner[0] is not None or is_last)
            ):
                raise self._busy(owner, is_locked)
            if not is_locked or (owner is not None and owner[0] is None) or not self._is_mine(descriptor):
                return False
            os.lseek(descriptor, 0, os.SEEK_SET)
            os.ftruncate(descriptor, 0)
            text = json.dumps({"pid": os.getpid(), "host": socket.gethostname(), "locked": True})
            os.write(descriptor, text.encode())
            self._descriptor, descriptor = descriptor, None
            return True
        finally:
            if descriptor is not None:
                os.close(descriptor)

    def _open(self):
        """(descriptor of the lock file, True if it is new), or (None, False)."""
        flags = os.O_RDWR | getattr(os, "O_BINARY", 0)
        try:
            return os.open(self._path, flags | os.O_CREAT | os.O_EXCL, 0o644), True
        except FileExistsError:
            pass
        try:
            return os.open(self._path, flags), False
        except FileNotFoundError:
            return None, False

    def _is_mine(self, descriptor):
        """True if the open file is still the one with the lock's name."""
        try:
            return os.path.samestat(os.fstat(descriptor), os.stat(self._path))
        except FileNotFoundError:
            return False

    def _busy(self, owner, may_be_left=False):
        pid, host, *_ = owner
        words = "another process" if pid is None else f"process {pid} on {host}"
        more = f", or delete {self._path} if there is no such process" if may_be_left else ""
        return SaveError(f"{self._target} is being baked by {words}: wait for its end{more}")


def _lock(descriptor):
    """Locks the open file until this process ends. Returns False if another process holds it; True as well on
    file systems without locks."""
    try:
        if fcntl is not None:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            os.lseek(descriptor, PLACE, os.SEEK_SET)
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
    except OSError as error:
        return error.errno not in (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES, errno.EDEADLK)
    return True


def _owner(descriptor):
    """(process id, host, whether the operating system's lock tells if it lives); None for an unknown id."""
    try:
        os.lseek(descriptor, 0, os.SEEK_SET)
        owner = json.loads(os.read(descriptor, 4096))
        return int(owner["pid"]), str(owner["host"]), bool(owner.get("locked"))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None, None, False


def _has_ended(owner):
    """True if the process has certainly ended, given that the operating system's lock is free."""
    pid, host, was_locked = owner
    if pid is None or host != socket.gethostname():
        return False
    if was_locked or pid == os.getpid():
        return True
    if os.name == "nt":  # there, signal 0 is Ctrl-C
        return False
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return False

# SPDX-License-Identifier: GPL-3.0-or-later
"""What a batch tells: lines on standard output, a log, and a manifest."""

import contextlib
import datetime
import json
import os
import sys
import time

import bpy

from ..base import native, preferences
from . import words
from .exit_codes import UsageError

FORMAT, SCHEMA = "lamina-batch", 1


class Report:
    """A context around a batch. Raises UsageError if the log or the manifest cannot be written.

    The manifest is written after each file, so that it also exists after a kill. Its `exit_code` is then
    null."""

    def __init__(self, arguments):
        self._manifest, self._log = arguments.manifest, None
        self._began = time.monotonic()
        self._data = {
            "format": FORMAT,
            "schema": SCHEMA,
            "lamina": native.require().__version__,
            "blender": bpy.app.version_string,
            "began": _now(),
            "seconds": 0.0,
            "dry_run": arguments.dry_run,
            "exit_code": None,
            "reason": None,
            "files": [],
            "materials": [],
        }
        try:
            self._write()
        except OSError as error:
            raise UsageError(f"--manifest {self._manifest}: {error.strerror}") from None
        try:
            if arguments.log is not None:
                # Names of files may hold bytes that are no text.
                self._log = open(  # noqa: SIM115 - closed at exit
                    arguments.log, "a", encoding="utf-8", errors="backslashreplace", buffering=1
                )
        except OSError as error:
            raise UsageError(f"--log {arguments.log}: {error.strerror}") from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        log, self._log = self._log, None
        try:
            if log is not None:
                log.close()
        except OSError as error:  # of lines that a full disk did not take
            self.complain(f"--log {log.name}: {error.strerror}")

    def line(self, text):
        print(text, flush=True)
        self._note(text)

    def complain(self, sentence):
        print(f"lamina: {sentence}", file=sys.stderr, flush=True)
        self._note(f"lamina: {sentence}")

    def material(self, file, record, text):
        """Tell what became of one material: its record and its line. `file` is None for the open one."""
        self._data["materials"].append({"file": _name(file), **record})
        self.line(
            f"{record['material']}: {text}" if file is None else f"{file}: {record['material']}: {text}"
        )

    def file(self, file, target, status, reason=""):
        """Tell what became of one file."""
        record = {
            "file": _name(file),
            "output": target and str(target),
            "status": status,
            "reason": reason or None,
        }
        self._data["files"].append(record)
        if file is not None:
            self.line(f"{file}: {status}" + (f": {reason}" if reason else ""))
        with contextlib.suppress(OSError):  # told at the end, if it is still so
            self._write()

    def counts(self):
        """{status: number of materials}."""
        statuses = [record["status"] for record in self._data["materials"]]
        return {status: statuses.count(status) for status in dict.fromkeys(statuses)}

    def finish(self, exit_code, reason=None):
        """Returns whether the manifest could be written."""
        self._data |= {"exit_code": exit_code, "reason": reason}
        self._note(f"lamina: exit code {exit_code}")
        try:
            self._write()
        except OSError as error:
            self.complain(f"--manifest {self._manifest}: {error.strerror}")
            return False
        return True

    def _note(self, text):
        if self._log is not None:
            with contextlib.suppress(OSError):  # a full disk must not end the batch
                self._log.write(f"{_now()} {text}\n")

    def _write(self):
        if self._manifest is None:
            return
        self._data["seconds"] = time.monotonic() - self._began
        text = json.dumps(self._data, indent=1) + "\n"
        native.part("common.atomic").write_atomically(self._manifest, lambda file: file.write(text.encode()))


def record(plan, status, seconds=0.0):
    """What the manifest holds of one material; its file is added later."""
    baked = None if status == "failed" else words.facts(plan.material.lamina.result)
    return {
        "material": plan.name,
        "status": status,
        "reason": plan.reason or None,
        "stack_hash": None if plan.wanted is None else plan.wanted.stack.hash,
        "quality": plan.quality,
        "basis": preferences.fit_of(plan.basis),
        "seconds": seconds,
        "not_carried_over": plan.lost,
        "baked": baked,
    }


def _name(file):
    return (
        str(file) if file is not None else (os.path.abspath(bpy.data.filepath) if bpy.data.filepath else None)
    )


def _now():
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")

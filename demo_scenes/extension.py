# SPDX-License-Identifier: GPL-3.0-or-later
"""The Lamina extension as on a user's machine: installed from its zip, into a separate profile.

Blender reads BLENDER_USER_RESOURCES when it starts, so `isolate` comes before the first `import bpy`.
"""

import contextlib
import importlib
import json
import os
import shutil
import tempfile
import time
from pathlib import Path

PACKAGE = "bl_ext.user_default.lamina"


class ExtensionMissingError(RuntimeError):
    """No extension to work with; str() is one sentence."""


@contextlib.contextmanager
def isolate():
    """An empty Blender profile for this process, removed at the end. Yields its folder."""
    folder = tempfile.mkdtemp(prefix="lamina-profile-")
    os.environ["BLENDER_USER_RESOURCES"] = folder
    try:
        yield Path(folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def installed(zip_path):
    """Install and enable the extension of `zip_path`; disable it at the end. Raises ExtensionMissingError.

    Disabling matters: classes that are still registered when Python exits make some versions of the
    bpy module hang.
    """
    import bpy
    import cycles_render

    addon_utils = importlib.import_module("addon_utils")  # found once bpy has been imported
    if not Path(zip_path).is_file():
        raise ExtensionMissingError(f"{zip_path}: no such file")

    with cycles_render.quiet():
        bpy.ops.extensions.package_install_files(
            filepath=str(zip_path), repo="user_default", enable_on_install=True
        )
    if not addon_utils.check(PACKAGE)[1]:
        raise ExtensionMissingError(f"{zip_path}: Blender did not install or enable this extension")
    try:
        yield
    finally:
        addon_utils.disable(PACKAGE)


def newest_zip(folder):
    """The newest extension zip in `folder`. Raises ExtensionMissingError."""
    found = sorted(Path(folder).glob("lamina-[0-9]*.zip"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise ExtensionMissingError(f"{folder} holds no lamina-*.zip: run `make extension` first")
    return found[-1]


def part(name):
    """A module of the enabled extension. Raises ExtensionMissingError."""
    try:
        return importlib.import_module(f"{PACKAGE}.{name}")
    except ModuleNotFoundError as error:
        raise ExtensionMissingError(f"the Lamina extension is not enabled here ({error})") from error


def bake(name, stack, quality="final", say=lambda text: None, basis="standard"):
    """(a new material with the baked `stack`, its LUT). `stack` is a dict as in stack.json.

    Uses the enabled extension. Raises ExtensionMissingError, and the errors of the bake.
    """
    import bpy

    stack_io, bake_job = part("editing.stack_io"), part("baking.bake_job")
    material = bpy.data.materials.new(name)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "stack.json"
        path.write_text(json.dumps(stack), encoding="utf-8")
        stack_io.import_file(material, str(path))
    return material, bake_job.bake_material(material, quality, progress=_told_seldom(say), basis=basis)


def _told_seldom(say, seconds=2.0):
    """A progress callable that says at most one line per `seconds`."""
    last = [time.monotonic()]

    def progress(fraction, text=""):
        if time.monotonic() - last[0] >= seconds:
            last[0] = time.monotonic()
            say(f"{fraction:.0%} {text}")

    return progress

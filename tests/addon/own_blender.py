# SPDX-License-Identifier: GPL-3.0-or-later
"""One Blender for all add-on tests: its own user folder, the add-on enabled from this clone.

Blender reads its user folder when bpy is imported, so the folder is set before.
"""

import atexit
import os
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MODULE = "bl_ext.user_default.lamina"

sys.dont_write_bytecode = True

if "bpy" in sys.modules:
    RESOURCES = Path(os.environ.get("BLENDER_USER_RESOURCES") or tempfile.mkdtemp(prefix="lamina-blender-"))
else:
    RESOURCES = Path(tempfile.mkdtemp(prefix="lamina-blender-"))
    os.environ["BLENDER_USER_RESOURCES"] = str(RESOURCES)
    (RESOURCES / "extensions" / "user_default").mkdir(parents=True)
    (RESOURCES / "extensions" / "user_default" / "lamina").symlink_to(
        ROOT / "addon", target_is_directory=True
    )

import bpy  # noqa: E402, F401, I001 (its scripts hold addon_utils)
import addon_utils  # noqa: E402


def enable():
    """Enable the add-on of this clone; its package."""
    package = addon_utils.enable(MODULE, default_set=True)
    assert package is not None, "the add-on could not be enabled"
    return package


def disable():
    addon_utils.disable(MODULE, default_set=True)


@atexit.register
def remove_resources():
    if RESOURCES.name.startswith("lamina-blender-"):
        shutil.rmtree(RESOURCES, ignore_errors=True)

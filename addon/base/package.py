# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's own name, under which Blender keeps its preferences and folders."""

from pathlib import Path

import bpy

NAME = __package__.rpartition(".")[0]  # such as bl_ext.user_default.lamina


def user_folder(name, create=False):
    """A folder of the user's own files. Raises OSError if it cannot be made."""
    if NAME.startswith("bl_ext."):
        return Path(bpy.utils.extension_path_user(NAME, path=name, create=create))
    return Path(bpy.utils.user_resource("CONFIG", path=f"lamina/{name}", create=create))

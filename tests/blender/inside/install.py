# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: installs and enables the extension's zip, and saves the preferences. Argument: the zip."""

import sys

import bpy

bpy.ops.extensions.package_install_files(
    filepath=sys.argv[-1], repo="user_default", enable_on_install=True, overwrite=True)
package = sys.modules["bl_ext.user_default.lamina"]
assert package.base.native.available(), package.base.native.reason()
bpy.ops.wm.save_userpref()

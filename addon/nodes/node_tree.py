# SPDX-License-Identifier: GPL-3.0-or-later
"""The node tree of a material or world, in every Blender from 4.2 on.

Imports nothing but bpy: demo_scenes/node_tree.py is a link to this file, for scenes and tests that render
without the add-on.
"""

import bpy


def of(owner):
    """The node tree of a material, world or lamp.

    Before Blender 5.0 it has to be switched on. From 5.0 on it is always there, and touching the switch
    warns: Blender 6.0 will not have the switch. Lamps keep the switch.
    """
    if _has_switch(owner):
        owner.use_nodes = True
    return owner.node_tree


def is_on(owner):
    """True if a material, world or lamp has nodes. From Blender 5.0 on every material and world has."""
    return not _has_switch(owner) or owner.use_nodes


def switch_off(owner):
    """Switch the nodes of a material or world off, before Blender 5.0."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = False


def _has_switch(owner):
    return bpy.app.version < (5, 0, 0) or isinstance(owner, bpy.types.Light)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The node tree of a material or world, in every Blender from 4.2 on.

Imports nothing but bpy: demo_scenes/node_tree.py is a link to this file, for scenes and tests that render
without the add-on.
"""

import bpy


def of(owner):
    """The node tree of a material, world or lamp.

    In older versions of Blender it has to be switched on; see _has_switch.
    """
    if _has_switch(owner):
        owner.use_nodes = True
    return owner.node_tree


def is_on(owner):
    """True if a material, world or lamp has nodes. Where there is no switch, each of them has."""
    return not _has_switch(owner) or owner.use_nodes


def switch_off(owner):
    """Switch the nodes of a material or world off, before Blender 5.0."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = False


def _has_switch(owner):
    """False where the tree is always there: for materials and worlds from Blender 5.0 on, for lamps in 5.2.

    The switch is then marked as deprecated, and touching it warns. Blender 6.0 will not have it."""
    switch = owner.bl_rna.properties.get("use_nodes")
    return switch is not None and not getattr(switch, "is_deprecated", False)

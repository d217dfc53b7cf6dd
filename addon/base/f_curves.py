# SPDX-License-Identifier: GPL-3.0-or-later
"""The F-curves of animation data."""

import bpy


def of_all(animation):
    """The collections of F-curves of the active action and of the actions in strips."""
    strips = [strip for track in animation.nla_tracks for strip in track.strips if strip.action]
    found = {}
    # Strips may share an action, whose curves count once.
    for one in (animation, *strips):
        if one.action is not None:
            found[one.action.session_uid, getattr(one, "action_slot_handle", 0)] = of_active(one)
    return [one for one in found.values() if one]


def of_active(animation):
    """The F-curves of the action of animation data or of a strip."""
    action = animation.action
    if action is None:
        return ()
    if bpy.app.version < (4, 4, 0):
        return action.fcurves
    # From Blender 4.4 on, each user of an action has a slot with curves of its own.
    bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags
            if bag.slot_handle == animation.action_slot_handle]
    return bags[0].fcurves if bags else ()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells other packages that the layers of a material, or the settings of an object's dust, have changed,
without importing them.

Property callbacks and the functions that add, remove or move layers call `tell`; the functions in
`listeners` only take note. Those in `refinements` are called when the wanted quality or fit of a material
changes, those in `turns` when the wanted source of its tangent does, those in `removals` when a material
loses its stack. Those in `dust_listeners` are called likewise, with an object, and those in `dust_switches`
when its dust turns live. Those in `losses` are called after an undo that has freed the image of a material,
node group or object.
"""

listeners = []
refinements = []
turns = []
removals = []
dust_listeners = []
dust_switches = []
losses = []


def tell(material):
    for listener in listeners:
        listener(material)


def edited(owner, _context=None):
    """Update callback of the properties that make a stack."""
    if owner.id_data is not None:
        tell(owner.id_data)


def wished(settings, _context=None):
    """Update callback of the properties that choose the quality and fit of a material."""
    for listener in refinements:
        listener(settings.id_data)


def turned(settings, _context=None):
    """Update callback of the property that chooses the tangent of a material."""
    for listener in turns:
        listener(settings.id_data)


def removed(material):
    """The stack of a material has been taken away."""
    for listener in removals:
        listener(material)


def lose_image(owner):
    """Undo has freed an image of this material, node group or object."""
    for listener in losses:
        listener(owner)


def dust_edited(settings, _context=None):
    """Update callback of the properties that make dust."""
    for listener in dust_listeners:
        listener(settings.id_data)


def dust_switched(settings, _context=None):
    """Live settling of an object has been turned on or off."""
    for listener in dust_switches:
        listener(settings.id_data)

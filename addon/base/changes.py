# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells other packages that the layers of a material have changed, without importing them.

Property callbacks and the functions that add, remove or move layers call `tell`; the functions in `listeners`
only take note. Those in `switches` are called when the Live button is pressed, those in `removals` when a
material loses its stack.
"""

listeners = []
switches = []
removals = []


def tell(material):
    for listener in listeners:
        listener(material)


def edited(owner, _context=None):
    """Update callback of the properties that make a stack."""
    if owner.id_data is not None:
        tell(owner.id_data)


def removed(material):
    """The stack of a material has been taken away."""
    for listener in removals:
        listener(material)


def switched(settings):
    """Live editing of a material has been turned on or off."""
    for listener in switches:
        listener(settings.id_data)

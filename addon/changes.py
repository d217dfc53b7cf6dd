# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells whoever listens that the layers of a material have changed.

Property callbacks and the functions that add, remove or move layers call it; `listeners` only take note.
`switches` hear of the Live button.
"""

listeners = []
switches = []


def tell(material):
    for listener in listeners:
        listener(material)


def edited(owner, _context=None):
    """Update callback of the properties that make a stack."""
    if owner.id_data is not None:
        tell(owner.id_data)


def switched(settings):
    """Live editing of a material has been turned on or off."""
    for listener in switches:
        listener(settings.id_data)

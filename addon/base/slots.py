# SPDX-License-Identifier: GPL-3.0-or-later
"""Material slots of objects."""


def materials_of(obj, without_slots=None):
    """The materials of an object's slots, None for empty ones; `[without_slots]` if there are no slots."""
    return [slot.material for slot in obj.material_slots] or [without_slots]

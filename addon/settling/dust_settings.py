# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of an object's dust: as lamina takes them, and as a text that shows whether dust is up to
date."""

import json
import math

import numpy as np
from mathutils import Vector

from ..kinds import dust as kinds

# Properties that are no settings of the dust on this object itself.
_OTHERS = {"rna_type", "name", "stops", "live", "image", "told", "settled", "largest", "largest_back"}


def text(settings):
    """All settings that change the dust, as JSON."""
    return json.dumps({prop.identifier: getattr(settings, prop.identifier) for prop in _properties(settings)})


def is_outdated(settings):
    """True if there is dust, settled with other settings. Files of earlier versions do not know all of them;
    others had their defaults."""
    if not (settings.told and settings.settled):
        return False
    try:
        settled = json.loads(settings.settled)
    except ValueError:
        return True  # not in full
    return any(getattr(settings, prop.identifier) != settled.get(prop.identifier, prop.default)
               for prop in _properties(settings))


def _properties(settings):
    return [prop for prop in settings.bl_rna.properties if prop.identifier not in _OTHERS]


def numbers(settings, scene):
    """Arguments of lamina's Settling: the settings in metres and radians, and the scene's gravity."""
    gravity = scene.gravity if scene.use_gravity and scene.gravity.length > 0.0 else Vector((0.0, 0.0, -1.0))
    towards = settings.wind_from + math.pi
    wind = settings.wind * np.array([math.cos(towards), math.sin(towards), 0.0])
    more = {
        "extinction": settings.substance,
        "gravity": tuple(gravity),
        "wind": tuple(wind),
        "grams" if settings.form == "tau" else "amount": None,
    }
    values = {one.name: _value(one, settings, scene) for one in kinds.OPTIONS if one.panel}
    return values | more


def _value(option, settings, scene):
    """The value of a property for lamina's Settling."""
    value = getattr(settings, option.name)
    if option.switch:
        return value
    if option.unit == "m":
        value *= scene.unit_settings.scale_length
    if option.optional and option.low > 0.0 and value == 0.0:
        return None
    return min(value, option.high)  # single precision rounds 180 degrees up

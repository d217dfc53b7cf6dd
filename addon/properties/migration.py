# SPDX-License-Identifier: GPL-3.0-or-later
"""Migration of older files' properties to this version.

Each step takes a material from schema n to n + 1. Steps are never edited, only added.
"""

import bpy
from bpy.app.handlers import persistent

from ..base import editable, handlers, timers
from . import material_properties
from .report_of_schema_2 import gather

STEPS = {2: gather}


def start(material):
    """Give `material` its layer settings, at this version's schema. Does nothing if it has them."""
    settings = material.lamina
    if not settings.enabled:
        settings.enabled = True
        settings.schema = material_properties.SCHEMA


def problem(material):
    """What a material is whose layers cannot be changed, after "The material is", or ''."""
    newer = "from a newer version of Lamina" if is_from_the_future(material) else ""
    return editable.problem(material) or newer


def is_from_the_future(material):
    """True if a newer Lamina wrote the material; it is then shown but not changed."""
    return material.lamina.schema > material_properties.SCHEMA


def migrate(material, steps=None, schema=None):
    """Bring one material up to date. Returns True if anything was changed."""
    steps = STEPS if steps is None else steps
    schema = material_properties.SCHEMA if schema is None else schema
    settings = material.lamina
    if not settings.enabled or not editable.is_editable(material):
        return False
    changed = False
    while settings.schema < schema:
        step = steps.get(settings.schema)
        if step is not None:
            step(material)
        settings.schema += 1
        changed = True
    return changed


def migrate_all():
    """Bring every material of the open file up to date."""
    for material in bpy.data.materials:
        migrate(material)


@persistent
def _on_load(*_):
    migrate_all()


def _once():
    """Migrates the file that is open when the add-on is enabled; bpy.data cannot be read earlier."""
    migrate_all()


HANDLERS = {"load_post": _on_load}


def register():
    handlers.add(HANDLERS)
    timers.start(_once)


def unregister():
    handlers.remove(HANDLERS)
    timers.end(_once)

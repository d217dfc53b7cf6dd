# SPDX-License-Identifier: GPL-3.0-or-later
"""Base classes of Lamina's panels in the Material tab."""

from ..properties import migration

EEVEE = {"BLENDER_EEVEE", "BLENDER_EEVEE_NEXT"}  # its names in different versions of Blender


class MaterialPanel:
    """A panel of materials with layers."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"
    COMPAT_ENGINES = {"CYCLES", *EEVEE}

    @classmethod
    def poll(cls, context):
        if context.material is None or context.engine not in cls.COMPAT_ENGINES:
            return False
        return cls.wanted(context.material)

    @classmethod
    def wanted(cls, material):
        return material.lamina.enabled and not migration.is_from_the_future(material)


class AnyMaterialPanel(MaterialPanel):
    """A panel of materials without layers, too."""

    @classmethod
    def wanted(cls, material):
        return material.grease_pencil is None

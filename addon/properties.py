# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material keeps in the .blend: its layers, its base, and the facts of its last bake.

A bake cannot follow an animation, so no property is animatable (`options=set()`). Whether a bake is
running, and why the last one failed, is not kept here: see bake_job.
"""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import changes
from .preferences import QUALITIES

SCHEMA = 1

LAYER_KINDS = (("medium", "Medium", "Scattering, absorbing particles: dust, pigment, haze", "MATFLUID", 0),)

PHASES = (
    ("isotropic", "Isotropic", "Light leaves a particle in all directions alike"),
    ("hg", "Henyey-Greenstein", "Forward or backward scattering, set by the anisotropy"),
    ("rayleigh", "Rayleigh", "Particles much smaller than the wavelength: haze, smoke"),
)

BASES = (
    ("none", "None (Thin Sheet)", "Nothing below: light also leaves through the back"),
    ("lambert", "Diffuse Surface", "A matte opaque surface of the given colour"),
    ("black", "Black", "A surface that absorbs all light"),
    ("half-space", "Deep Medium", "A medium without bottom: soil, snow, thick paint"),
)


def _rgb(name, default, description, largest=1.0, **options):
    return FloatVectorProperty(
        name=name,
        description=description,
        size=3,
        default=(default,) * 3,
        min=0.0,
        max=largest,
        update=changes.edited,
        options=set(),
        **options,
    )


def _phase():
    return EnumProperty(
        name="Phase Function",
        description="How a particle spreads the light that it scatters",
        items=PHASES,
        default="hg",
        update=changes.edited,
        options=set(),
    )


def _anisotropy():
    return FloatProperty(
        name="Anisotropy",
        description="Mean cosine g of the scattering angle: below 0 back towards the light, above 0 onwards",
        default=0.6,
        min=-0.99,
        max=0.99,
        step=1,
        precision=3,
        update=changes.edited,
        options=set(),
    )


def _varying_changed(layer, _context):
    """A stack has one thickness axis at most: the last choice wins."""
    if layer.varying:
        for other in layer.id_data.lamina.layers:
            if other != layer and other.varying:
                other.varying = False
    changes.edited(layer)


class LaminaLayer(bpy.types.PropertyGroup):
    name: StringProperty(
        name="Name", description="Name of this layer, for you", default="Layer", options=set()
    )
    kind: EnumProperty(
        name="Kind",
        description="What this layer is made of",
        items=LAYER_KINDS,
        update=changes.edited,
        options=set(),
    )
    mode: EnumProperty(
        name="Given By",
        description="Which numbers describe the medium",
        items=(
            ("optical", "Albedo", "By albedo and optical thickness"),
            (
                "coefficients",
                "Per mm",
                "By scattering and absorption per millimetre, and thickness",
            ),
        ),
        update=changes.edited,
        options=set(),
    )
    albedo: _rgb(
        "Albedo", 0.8, "Share of the light that a scattering event keeps, per channel", subtype="COLOR"
    )
    tau: FloatProperty(
        name="Optical Thickness",
        description="Mean number of events straight through: 0.1 is a veil, 1 is dusty, 10 hides the base",
        default=1.0,
        min=0.0,
        max=1.0e6,
        soft_max=20.0,
        step=10,
        precision=3,
        update=changes.edited,
        options=set(),
    )
    tau_per_channel: BoolProperty(
        name="Per Channel",
        description="Give red, green and blue an optical thickness of their own",
        update=changes.edited,
        options=set(),
    )
    tau_rgb: _rgb(
        "Optical Thickness",
        1.0,
        "Optical thickness in red, green and blue",
        1.0e6,
        soft_max=20.0,
        precision=3,
        step=10,
    )
    infinite: BoolProperty(
        name="Infinite",
        description="This layer has no bottom; nothing below it is seen",
        update=changes.edited,
        options=set(),
    )
    sigma_s: _rgb(
        "Scattering",
        1.0,
        "Scattering coefficient in 1/mm, per channel",
        1.0e6,
        soft_max=20.0,
        precision=4,
        step=10,
    )
    sigma_a: _rgb(
        "Absorption",
        0.1,
        "Absorption coefficient in 1/mm, per channel",
        1.0e6,
        soft_max=20.0,
        precision=4,
        step=10,
    )
    thickness: FloatProperty(
        name="Thickness",
        description="Thickness of the layer in millimetres",
        default=1.0,
        min=0.0,
        max=1.0e6,
        soft_max=10.0,
        step=10,
        precision=4,
        update=changes.edited,
        options=set(),
    )
    phase: _phase()
    g: _anisotropy()
    varying: BoolProperty(
        name="Varying Thickness",
        description="Give the node group a Thickness input, from 0 to this layer's optical thickness. "
        "One layer of a stack can vary",
        update=_varying_changed,
        options=set(),
    )


class LaminaBase(bpy.types.PropertyGroup):
    kind: EnumProperty(
        name="Base",
        description="What lies below the layers",
        items=BASES,
        default="lambert",
        update=changes.edited,
        options=set(),
    )
    reflectance: _rgb(
        "Reflectance", 0.5, "Share of the light that the surface reflects, per channel", subtype="COLOR"
    )
    albedo: _rgb(
        "Albedo", 0.8, "Share of the light that a scattering event keeps, per channel", subtype="COLOR"
    )
    phase: _phase()
    g: _anisotropy()


class LaminaResult(bpy.types.PropertyGroup):
    """The facts of the last finished bake, copied from the LUT's report."""

    stack_hash: StringProperty(description="Hash of the stack that was baked; empty before the first bake")
    quality: StringProperty()
    fit_error: FloatProperty(description="Mean over slices of the relative L2 error, reflection")
    fit_error_transmission: FloatProperty(description="For transmission; negative when there is none")
    worst_error: FloatProperty(description="Relative L2 error of the worst slice")
    worst_mu: FloatProperty(description="View cosine of the worst slice")
    worst_channel: IntProperty()
    worst_side: StringProperty()
    worst_tau: FloatProperty(description="Its row's optical thickness; negative when none varies")
    albedo_error: FloatProperty(description="Worst relative error of the directional albedo")
    energy_error: FloatProperty()
    closures: IntProperty()
    seconds: FloatProperty()


class LaminaMaterial(bpy.types.PropertyGroup):
    enabled: BoolProperty(description="This material has a layer stack")
    schema: IntProperty(description="Version of these properties; 0 before the first use")
    layers: CollectionProperty(type=LaminaLayer)
    active_index: IntProperty(name="Active Layer", options=set())
    base: PointerProperty(type=LaminaBase)
    quality: EnumProperty(
        name="Quality", description="How exactly to bake", items=QUALITIES, default="final", options=set()
    )
    live: BoolProperty(
        name="Live",
        description="Bake again at preview quality whenever a layer changes, and show it at once",
        update=lambda settings, _context: changes.switched(settings),
        options=set(),
    )
    result: PointerProperty(type=LaminaResult)
    node_group: PointerProperty(type=bpy.types.NodeTree, description="What the bake keeps up to date")


CLASSES = (LaminaLayer, LaminaBase, LaminaResult, LaminaMaterial)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Material.lamina = PointerProperty(type=LaminaMaterial, name="Lamina")


def unregister():
    del bpy.types.Material.lamina
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)

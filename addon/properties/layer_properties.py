# SPDX-License-Identifier: GPL-3.0-or-later
"""What one layer and the base keep: every number of the stack's JSON that the panel can edit.

Choices are saved as their numbers, and what was never touched is not saved at all: numbers and defaults here
never change, new ones are only added. No property is animatable: a bake cannot follow an animation.
"""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    PointerProperty,
    StringProperty,
)

from ..base import changes, decimals
from ..stack_json import solved_colours

LAYER_KINDS = (
    ("medium", "Medium", "Scattering, absorbing particles: dust, pigment, haze", "MATFLUID", 0),
    ("interface", "Interface", "A boundary that reflects and refracts: the surface of varnish, glass, water",
     "MESH_PLANE", 1),
)  # fmt: skip

MODES = (
    ("colour", "Colour", "By the colour that it shows, and optical thickness", 2),
    ("optical", "Albedo", "By albedo and optical thickness", 0),
    ("coefficients", "Per mm", "By scattering and absorption per millimetre, and thickness", 1),
)

PHASES = (
    ("isotropic", "Isotropic", "Light leaves a particle in all directions alike", 0),
    ("hg", "Henyey-Greenstein", "Forward or backward scattering, set by the anisotropy", 1),
    ("double-hg", "Double Henyey-Greenstein", "Two lobes: most often one forward and a weak one back", 3),
    ("rayleigh", "Rayleigh", "Particles much smaller than the wavelength: haze, smoke", 2),
    ("cornette-shanks", "Cornette-Shanks", "From Rayleigh scattering at 0 into a forward lobe", 5),
    ("draine", "Draine", "Henyey-Greenstein with more light forward and back: dust, droplets", 4),
)

BASES = (
    ("none", "None (Thin Sheet)", "Nothing below: light also leaves through the back", 0),
    ("lambert", "Diffuse Surface", "A matte opaque surface of the given colour", 1),
    ("conductor", "Metal", "A metal, by its refractive index or by its colours", 4),
    ("black", "Black", "A surface that absorbs all light", 2),
    ("half-space", "Deep Medium", "A medium without bottom: soil, snow, thick paint", 3),
)

DISTRIBUTIONS = (
    ("ggx", "GGX", "Facets with a narrow peak and long tails: most real surfaces", 0),
    ("beckmann", "Beckmann", "Facets without tails: ground glass, some varnishes", 1),
)

METAL_FORMS = (
    ("indices", "Index", "By the complex refractive index, per channel", 0),
    ("colours", "Colours", "By the colours that it shows facing and grazing", 1),
)

# What a metal's numbers are in a file that never set them.
UNSET_METAL = {
    "eta": (0.2141, 0.4547, 1.332),
    "k": (3.251, 2.406, 1.869),
    "facing": (0.929, 0.77, 0.403),
    "grazing": (0.946, 0.875, 0.677),
}
# The library's gold, in both forms: a base that becomes a metal needs some first numbers.
GOLD = {
    "metal_form": "colours",
    "facing": (1.0, 0.7837, 0.3427),
    "grazing": (1.0, 0.8899, 0.6307),
    "eta": (0.001, 0.385032725553, 1.60385830131),
    "k": (63.2376311929, 2.28079605351, 1.72632665315),
}


def _number(name, default, description, low, high, **options):
    settings = {"step": 1, "precision": 3, "update": changes.edited, "options": set(), **options}
    return FloatProperty(name=name, description=description, default=default, min=low, max=high, **settings)


def _rgb(name, default, description, largest=1.0, low=0.0, **options):
    default = default if isinstance(default, tuple) else (default,) * 3
    settings = {"update": changes.edited, "options": set(), **options}
    return FloatVectorProperty(
        name=name, description=description, size=3, default=default, min=low, max=largest, **settings
    )


def _choice(name, items, description, default=None, update=changes.edited):
    default = items[0][0] if default is None else default
    return EnumProperty(
        name=name, description=description, items=items, default=default, update=update, options=set()
    )


def _switch(name, description, default=False, update=changes.edited):
    return BoolProperty(name=name, description=description, default=default, update=update, options=set())


def _anisotropy(name, default, description):
    return _number(name, default, description, -0.99, 0.99)


class PhaseProperties:
    """A phase function. `phase_text`, when there is any, is the JSON of one that the panel cannot edit."""

    phase: _choice("Phase Function", PHASES, "How a particle spreads the light that it scatters", "hg")
    g: _anisotropy(
        "Anisotropy",
        0.6,
        "Forward (above 0) or backward (below 0) scattering; for Henyey-Greenstein the mean cosine",
    )
    g1: _anisotropy("First Anisotropy", 0.8, "Anisotropy of the first lobe")
    g2: _anisotropy("Second Anisotropy", -0.3, "Anisotropy of the second lobe")
    weight: _number("Weight", 0.9, "Share of the first lobe", 0.0, 1.0)
    draine_alpha: _number(
        "Alpha", 1.0, "0 is Henyey-Greenstein, 1 is Cornette-Shanks", 0.0, 1000.0, soft_max=10.0, step=10
    )
    phase_text: StringProperty(
        name="Imported Phase Function",
        description="JSON, as it was imported",
        update=changes.edited,
        options=set(),
    )


def _set_roughness(owner, value):
    owner.alpha = decimals.shortest(value) ** 2


class FacetProperties:
    """A rough surface. Stacks speak of `alpha`; the panel shows Blender's Roughness, its square root."""

    alpha: _number("Alpha", 0.0, "Microfacet width: roughness squared", 0.0, 1.0, precision=4)
    roughness: FloatProperty(
        name="Roughness",
        description="0 is smooth; as in Blender's own shaders, the square root of the microfacet width",
        min=0.0,
        max=1.0,
        step=1,
        precision=3,
        subtype="FACTOR",
        get=lambda owner: owner.alpha**0.5,
        set=_set_roughness,
        options=set(),
    )
    distribution: _choice("Distribution", DISTRIBUTIONS, "How the slopes of the facets are spread")
    compensate: _switch(
        "Keep Energy", "Give back the light that facets which scatter it only once would lose", True
    )
    correlated: _switch(
        "Correlated Masking", "Facets hidden from one side are more often hidden from the other too", True
    )


def _kind_changed(layer, _context):
    if layer.kind != "medium":
        layer.varying = False
    changes.edited(layer)


def _varying_changed(layer, _context):
    """A stack has one thickness axis at most: the last choice wins."""
    if layer.varying:
        for other in layer.id_data.lamina.layers:
            if other != layer and other.varying:
                other.varying = False
    changes.edited(layer)


def _graded_changed(layer, _context):
    """The bottom starts as the top is: what was never set there is taken over."""
    if layer.graded:
        for prop in layer.bottom.bl_rna.properties:
            name = prop.identifier
            if not prop.is_readonly and name != "name" and not layer.bottom.is_property_set(name):
                setattr(layer.bottom, name, getattr(layer, name))
    changes.edited(layer)


class MediumProperties(PhaseProperties):
    """What scatters in a medium, at one depth."""

    colour: _rgb(
        "Colour", 0.8, "What the layer shows under diffuse light: infinitely thick, or over the given base",
        subtype="COLOR",
    )  # fmt: skip
    albedo: _rgb(
        "Albedo", 0.8, "Share of the light that a scattering event keeps, per channel", subtype="COLOR"
    )
    shown_colour: FloatVectorProperty(
        name="Shown",
        description="The colour of this medium, infinitely thick, under diffuse light",
        size=3,
        subtype="COLOR",
        get=lambda medium: solved_colours.thick_colour(medium) or (0.0, 0.0, 0.0),
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


class LaminaDepth(MediumProperties, bpy.types.PropertyGroup):
    """The bottom of a medium that changes with depth."""


class LaminaLayer(MediumProperties, FacetProperties, bpy.types.PropertyGroup):
    name: StringProperty(
        name="Name", description="Name of this layer, for you", default="Layer", options=set()
    )
    kind: _choice("Kind", LAYER_KINDS, "What this layer is", update=_kind_changed)
    # An interface
    ior: _number("IOR", 1.5, "Refractive index of all that lies below, down to the next interface", 1.0, 4.0)
    ior_per_channel: _switch("IOR per Channel", "Give red, green and blue a refractive index of their own")
    ior_rgb: _rgb("IOR", 1.5, "Refractive index in red, green and blue", 4.0, 1.0, precision=3, step=1)
    # A medium
    mode: _choice("Given By", MODES, "Which numbers describe the medium", "optical")
    over_given: _switch("Over", "The colour is what this layer, as thick as it is, shows over a base")
    over: _rgb("Over", 0.5, "Reflectance of the base over which the colour is meant", subtype="COLOR")
    graded: _switch(
        "Changes with Depth",
        "Give the bottom of this layer numbers of its own; what lies between is a blend",
        update=_graded_changed,
    )
    bottom: PointerProperty(type=LaminaDepth)
    profile_text: StringProperty(
        name="Imported Profile", description="JSON, as it was imported", update=changes.edited, options=set()
    )
    tau: _number(
        "Optical Thickness",
        1.0,
        "Mean number of events straight through: 0.1 is a veil, 1 is dusty, 10 hides the base",
        0.0,
        1.0e6,
        soft_max=20.0,
        step=10,
    )
    tau_per_channel: _switch("Per Channel", "Give red, green and blue an optical thickness of their own")
    tau_rgb: _rgb(
        "Optical Thickness",
        1.0,
        "Optical thickness in red, green and blue",
        1.0e6,
        soft_max=20.0,
        precision=3,
        step=10,
    )
    infinite: _switch("Infinite", "This layer has no bottom; nothing below it is seen")
    thickness: _number(
        "Thickness",
        1.0,
        "Thickness of the layer in millimetres",
        0.0,
        1.0e6,
        soft_max=10.0,
        step=10,
        precision=4,
    )
    varying: _switch(
        "Varying Thickness",
        "Give the node group a Thickness input, from 0 to this layer's optical thickness. "
        "One layer of a stack can vary",
        update=_varying_changed,
    )


def _base_kind_changed(base, context):
    """Properties have one default for ever, so the first metal of a base is set here."""
    if base.kind == "conductor" and not any(base.is_property_set(name) for name in GOLD):
        for name, value in GOLD.items():
            setattr(base, name, value)
    changes.edited(base, context)


class LaminaBase(PhaseProperties, FacetProperties, bpy.types.PropertyGroup):
    kind: _choice("Base", BASES, "What lies below the layers", "lambert", update=_base_kind_changed)
    reflectance: _rgb(
        "Reflectance", 0.5, "Share of the light that the surface reflects, per channel", subtype="COLOR"
    )
    textured: _switch(
        "Base Colour from Input", "Give the node group a base colour input, for a texture; bakes take longer"
    )
    albedo: _rgb(
        "Albedo", 0.8, "Share of the light that a scattering event keeps, per channel", subtype="COLOR"
    )
    metal_form: _choice("Given By", METAL_FORMS, "Which numbers describe the metal")
    eta: _rgb("Index n", UNSET_METAL["eta"], "Real part of the refractive index", 100.0, 0.001, precision=3)
    k: _rgb("Extinction k", UNSET_METAL["k"], "Imaginary part of the refractive index", 100.0, precision=3)
    facing: _rgb("Facing", UNSET_METAL["facing"], "What the metal reflects straight back", subtype="COLOR")
    grazing: _rgb(
        "Grazing",
        UNSET_METAL["grazing"],
        "What the metal reflects at a grazing view, 82 degrees",
        subtype="COLOR",
    )

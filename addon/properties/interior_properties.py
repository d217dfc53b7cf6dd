# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of an interior: its end materials, how they mix inside an object, and what is computed from
them.

Numbers and defaults never change, because a .blend file does not store unchanged values.
"""

import bpy
from bpy.props import (
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

SOURCES = (
    ("MARBLE", "Marble", "Veins in planes that turbulence distorts, between two materials", 0),
    (
        "NODES",
        "Node Texture",
        "The texture of the material's own colour or density, between two materials",
        1,
    ),
    ("LAYERS", "Homogeneous", "The one medium of the material's layers, everywhere", 2),
)
OUTPUTS = (
    (
        "RELIGHTABLE",
        "Relightable",
        "Subsurface Scattering nodes with a color and radius for each texel, for any light",
        0,
    ),
    (
        "LIT",
        "Lit",
        "The light that leaves each texel, for each sun and for the world: lamps may change in strength "
        "and color, but not move",
        1,
    ),
)
MAPS = (
    ("OWN", "UV Map", "A UV map of the object, without overlaps; Lamina unwraps an object that has none", 0),
    ("NEW", "Unwrap", "A UV map named Lamina, unwrapped automatically", 1),
)
VIEWS = (
    ("ALL", "All", "The mean over directions: for moving cameras", 0),
    ("CAMERA", "Camera", "The light towards the scene's camera: exact from its present place", 1),
)


def _coefficients(label, tip, default):
    return FloatVectorProperty(
        name=label,
        description=tip,
        size=3,
        default=default,
        min=0.0,
        max=65504.0,
        soft_max=10.0,
        precision=4,
        step=1,
        options=set(),
    )


def _length(label, tip, default):
    return FloatProperty(
        name=label,
        description=tip,
        default=default,
        min=1e-3,
        max=1e6,
        soft_max=100.0,
        precision=3,
        options=set(),
    )


class LaminaEndMaterial(bpy.types.PropertyGroup):
    sigma_s: _coefficients(
        "Scattering", "Scattering coefficient of red, green and blue, per mm", (2.19, 2.62, 3.0)
    )
    sigma_a: _coefficients(
        "Absorption", "Absorption coefficient of red, green and blue, per mm", (0.0021, 0.0041, 0.0071)
    )
    g: FloatProperty(
        name="Anisotropy",
        description="Mean cosine of the scattering angle; above 0 scatters forwards",
        default=0.0,
        min=-0.999,
        max=0.999,
        options=set(),
    )
    preset: StringProperty(description="Name of the preset that filled the numbers; empty after none")


class LaminaInterior(bpy.types.PropertyGroup):
    source: EnumProperty(name="Interior", description="What fills the object", items=SOURCES, options=set())
    first: PointerProperty(type=LaminaEndMaterial, name="Ground")
    second: PointerProperty(type=LaminaEndMaterial, name="Veins")
    ior: FloatProperty(
        name="IOR",
        description="Index of refraction of the object's surface; 1 is no boundary",
        default=1.5,
        min=1.0,
        max=3.8,
        options=set(),
    )
    roughness: FloatProperty(
        name="Roughness",
        description="Roughness of the object's surface; 0 is polished",
        default=0.3,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        options=set(),
    )
    resolution: IntProperty(
        name="Voxels",
        description="Number of voxels along the longest side of the object",
        default=128,
        min=1,
        max=512,
        options=set(),
    )
    # Marble
    spacing: _length("Spacing", "Distance between veins before they are distorted, in mm", 12.0)
    width: FloatProperty(
        name="Width",
        description="Width of veins, relative to their spacing",
        default=0.25,
        min=0.001,
        max=1.0,
        options=set(),
    )
    direction: FloatVectorProperty(
        name="Direction",
        description="Normal of the planes of veins, in the object's axes",
        size=3,
        default=(0.5, 0.3, 0.8),
        min=-1.0,
        max=1.0,
        options=set(),
    )
    distortion: FloatProperty(
        name="Distortion",
        description="Displacement of the veins by turbulence, relative to their spacing",
        default=3.0,
        min=0.0,
        max=100.0,
        soft_max=10.0,
        options=set(),
    )
    feature: _length("Feature Size", "Size of the largest distortions, in mm", 20.0)
    octaves: IntProperty(
        name="Detail",
        description="Number of octaves of the turbulence",
        default=6,
        min=1,
        max=12,
        options=set(),
    )
    seed: IntProperty(name="Seed", description="Seed of the veins", min=0, options=set())
    # Node texture
    node: StringProperty(
        name="Node",
        description="The node of the texture; empty: the one linked to the color or density",
        options=set(),
    )
    socket: StringProperty(name="Output", description="The node's output; empty: the first", options=set())
    # What is computed
    output: EnumProperty(name="Output", description="What the nodes show", items=OUTPUTS, options=set())
    view: EnumProperty(
        name="View", description="The directions of light that Lit shows", items=VIEWS, options=set()
    )
    map: EnumProperty(name="Map", description="The UV map of the images", items=MAPS, options=set())
    uv_map: StringProperty(name="UV Map", description="Empty: the active one for rendering", options=set())
    size: IntProperty(
        name="Size",
        description="Width and height of the images in texels",
        default=256,
        min=4,
        max=8192,
        options=set(),
    )
    noise: FloatProperty(
        name="Noise",
        description="Standard error of a texel, in percent of the mean; half the noise takes four times "
        "as long",
        default=3.0,
        min=0.01,
        max=100.0,
        soft_min=0.5,
        soft_max=20.0,
        precision=1,
        subtype="PERCENTAGE",
        options=set(),
    )
    # The last result
    report: StringProperty(description="The last result in words; empty before the first")
    suns: StringProperty(
        description="JSON of the suns of the last Lit: name, direction, angle; empty after others"
    )
    shown_on: StringProperty(description="Name of the object of the last result")


CLASSES = (LaminaEndMaterial, LaminaInterior)

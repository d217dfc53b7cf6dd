# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of an interior: its end materials, how they mix inside an object, and what is computed from
them. The numbers come from `kinds.interiors`.

Numbers of choices and defaults never change, because a .blend file does not store unchanged values.
"""

import bpy
from bpy.props import EnumProperty, FloatVectorProperty, PointerProperty, StringProperty

from ..kinds import interiors
from .described import having, quantities

SOURCES = (
    ("MARBLE", "Marble", "Veins in planes that turbulence distorts, between two materials", 0),
    (
        "NODES",
        "Node Texture",
        "The texture of the material's own color or density, between two materials",
        1,
    ),
    ("LAYERS", "One Medium", "The one medium of the material's layers, everywhere", 2),
)
OUTPUTS = (
    (
        "RELIGHTABLE",
        "Lamps May Move",
        "Subsurface Scattering nodes with a color and radius for each texel, for any light",
        0,
    ),
    (
        "LIT",
        "Lamps Stay",
        "The light that leaves each texel, for each lamp and for the world: lamps may change in strength "
        "and color, but not move",
        1,
    ),
)
MAPS = (
    ("OWN", "UV Map", "A UV map of the object, without overlaps; Lamina unwraps an object that has none", 0),
    ("NEW", "Unwrap", "A UV map named Lamina, unwrapped automatically", 1),
)
VIEWS = (
    ("ALL", "All", "The light in all directions, approximately: for moving cameras", 0),
    ("CAMERA", "Camera", "The light towards the scene's camera: exact from its present place", 1),
)


class EndProperties:
    preset: StringProperty(description="Name of the preset that filled the numbers; empty after none")


@having(quantities(interiors.GROUND, None))
class LaminaGround(EndProperties, bpy.types.PropertyGroup):
    """An end material, by default white marble."""


@having(quantities(interiors.VEINS, None))
class LaminaVeins(EndProperties, bpy.types.PropertyGroup):
    """An end material, by default a darker one."""


NUMBERS = tuple(field for field in (*interiors.MARBLE, *interiors.BODY, *interiors.MAPS) if field.panel)


@having(quantities(NUMBERS, None))
class LaminaInterior(bpy.types.PropertyGroup):
    source: EnumProperty(name="Interior", description="What fills the object", items=SOURCES, options=set())
    first: PointerProperty(type=LaminaGround, name="Ground")
    second: PointerProperty(type=LaminaVeins, name="Veins")
    direction: FloatVectorProperty(
        name="Direction",
        description="Normal of the planes of veins, in the object's axes",
        size=3,
        default=interiors.DIRECTION,
        min=-1.0,
        max=1.0,
        options=set(),
    )
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
        name="View", description="Directions of the light that the images show", items=VIEWS, options=set()
    )
    map: EnumProperty(name="Map", description="The UV map of the images", items=MAPS, options=set())
    uv_map: StringProperty(name="UV Map", description="Empty: the active one for rendering", options=set())
    # The last result
    report: StringProperty(description="The last result in words; empty before the first")
    made_from: StringProperty(
        description="JSON of what the last result was computed from, see interior.freshness; empty before"
    )


CLASSES = (LaminaGround, LaminaVeins, LaminaInterior)

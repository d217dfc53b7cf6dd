# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object keeps of the dust on it: how it falls, what stays, where it goes, the last time's facts.

Choices are saved as their numbers: numbers and defaults here never change, new ones are only added.
"""

import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

FORMS = (
    ("tau", "Optical Thickness", "By the optical thickness on an open horizontal plate", 0),
    ("mass", "Mass", "By mass per area, and what a gram of this dust covers", 1),
)

# Those of lamina.dust_materials.
SUBSTANCES = (
    ("dust-saharan-1.7um", "Desert Dust", "Saharan dust of 1.7 micrometres", 0),
    ("dust-saharan-fine-0.85um", "Desert Dust, Fine", "Saharan dust of 0.85 micrometres", 1),
    ("dust-saharan-coarse-6.6um", "Desert Dust, Coarse", "Saharan dust of 6.6 micrometres", 2),
    ("dust-san-juan-1.7um", "Grey Dust", "San Juan dust of 1.7 micrometres", 3),
    ("dust-mars-like-1.7um", "Red Dust", "Mars-like dust of 1.7 micrometres", 4),
    ("ash-mount-st-helens", "Volcanic Ash", "Ash of Mount St. Helens", 5),
    ("soot-40nm", "Soot", "Soot of 40 nanometres", 6),
    ("snow-100um", "Snow, Fine", "Snow grains of 100 micrometres", 7),
    ("snow-500um", "Snow, Coarse", "Snow grains of 500 micrometres", 8),
)

TARGETS = (
    (
        "attribute",
        "Attribute",
        "A float attribute of the mesh: one value a vertex, or a face corner where edges are hard",
        0,
    ),
    ("image", "Image", "A packed float image over a UV map, for a material of this object alone", 1),
)

ATTRIBUTE = "lamina_dust"
BACK_ATTRIBUTE = "lamina_dust_back"  # what lies on back faces, where dust lies on both sides


def _angle(name, degrees, description, highest=180.0, lowest=0.0):
    return FloatProperty(
        name=name, description=description, subtype="ANGLE", default=math.radians(degrees),
        min=math.radians(lowest), max=math.radians(highest), options=set(),
    )  # fmt: skip


def _share(name, default, description):
    return FloatProperty(
        name=name, description=description, subtype="FACTOR", default=default, min=0.0, max=1.0, options=set()
    )


class LaminaDust(bpy.types.PropertyGroup):
    form: EnumProperty(name="Given By", description="What says how much falls", items=FORMS, options=set())
    amount: FloatProperty(
        name="Amount",
        description="Optical thickness on an open horizontal plate: 0.1 is a veil, 1 is dusty, 10 hides all",
        default=1.0, min=0.0, max=1000.0, soft_max=10.0, step=10, options=set(),
    )  # fmt: skip
    grams: FloatProperty(
        name="Mass",
        description="Grams on a square metre of an open horizontal plate",
        default=2.0, min=0.0, max=1.0e6, soft_max=50.0, step=10, options=set(),
    )  # fmt: skip
    substance: EnumProperty(
        name="Dust", description="What falls: its mass extinction", items=SUBSTANCES, options=set()
    )
    time: FloatProperty(
        name="Time",
        description="For how long it falls: so many times the amount",
        default=1.0, min=0.0, max=1.0e6, soft_max=10.0, step=10, options=set(),
    )  # fmt: skip
    spread: _angle("Spread", 35.0, "Half-angle of the cone from which grains fall", 85.0)
    wind_from: _angle(
        "Wind From", 0.0, "Where the wind blows from, counted from the X axis towards Y", 360.0, -360.0
    )
    wind: FloatProperty(
        name="Wind",
        description="Speed of the wind over that of the fall: 1 tilts the fall by 45 degrees",
        default=0.0, min=0.0, max=20.0, soft_max=3.0, step=10, options=set(),
    )  # fmt: skip
    repose: _angle("Slope", 45.0, "Where a surface is steeper, more than half of the grains slide off")
    concavity: _share("Concavity", 0.5, "How much of what would slide off stays in corners and folds")
    coverage: _share("Coverage", 1.0, "Share of the surface that keeps its dust; elsewhere it is wiped off")
    patch: FloatProperty(
        name="Patch Size", description="Size of those patches; 0 is a tenth of the object",
        subtype="DISTANCE", default=0.0, min=0.0, max=1.0e6, soft_max=1.0, options=set(),
    )  # fmt: skip
    two_sided: BoolProperty(
        name="Two-Sided",
        description="Dust lies on either side of a face: leaves, cloth. Each side shows its own",
        options=set(),
    )
    rays: IntProperty(
        name="Rays", description="Rays a point: more are slower and smoother", default=256, min=1, max=65536,
        soft_min=16, soft_max=4096, options=set(),
    )  # fmt: skip
    seed: IntProperty(name="Seed", description="Another seed, other noise and patches", min=0, options=set())
    others: BoolProperty(
        name="Other Objects",
        description="Objects that are rendered and cast shadows keep dust from this one",
        default=True, options=set(),
    )  # fmt: skip
    stops: BoolProperty(
        name="Keeps Dust Off Others",
        description="Off for domes, backdrops and all else that dust should fall through",
        default=True, options=set(),
    )  # fmt: skip
    target: EnumProperty(name="To", description="Where the dust is kept", items=TARGETS, options=set())
    size: IntProperty(
        name="Size", description="Width and height of the image", default=1024, min=16, max=8192,
        options=set(),
    )  # fmt: skip
    uv_map: StringProperty(name="UV Map", description="Empty: the active one for rendering", options=set())
    image: PointerProperty(type=bpy.types.Image, description="What the dust was last kept in, if an image")
    # The facts of the last time
    told: StringProperty(description="The facts in words; empty before the first time")
    largest: FloatProperty(description="The largest optical thickness")
    largest_back: FloatProperty(description="The largest optical thickness on back faces")


def register():
    bpy.utils.register_class(LaminaDust)
    bpy.types.Object.lamina_dust = PointerProperty(type=LaminaDust, name="Lamina Dust")


def unregister():
    del bpy.types.Object.lamina_dust
    bpy.utils.unregister_class(LaminaDust)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of an object's dust: how it falls, how much stays, where it is stored, and the last report.

The options of the settling come from `kinds.dust`. A .blend file stores the number of a choice: numbers and
defaults never change, new ones are only added.
"""

import dataclasses
import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..kinds import dust, substances
from .described import dust_number, entries, having

FORMS = (
    ("tau", "Optical Thickness", "By the optical thickness on an open horizontal plate", 0),
    ("mass", "Mass", "By mass per area, and what a gram of this dust covers", 1),
)

SUBSTANCES = entries(material.item for material in substances.DUSTS.values())

TARGETS = (
    (
        "attribute",
        "Attribute",
        "A float attribute of the mesh: one value a vertex, or a face corner where edges are hard",
        0,
    ),
    ("image", "Image", "A packed float image over a UV map, for a material of this object alone", 1),
)

_DEFAULTS = {member.name: member.default for member in dataclasses.fields(dust.Settling)}


@having({one.name: dust_number(one, _DEFAULTS[one.name]) for one in dust.OPTIONS if one.panel})
class LaminaDust(bpy.types.PropertyGroup):
    form: EnumProperty(
        name="Amount By", description="Whether the amount is a thickness or a mass", items=FORMS,
        options=set(),
    )  # fmt: skip
    substance: EnumProperty(
        name="Dust", description="The kind of dust: its mass extinction", items=SUBSTANCES, options=set()
    )
    wind_from: FloatProperty(
        name="Wind From",
        description="Where the wind blows from, counted from the X axis towards Y",
        subtype="ANGLE", default=0.0, min=math.radians(-360.0), max=math.radians(360.0), options=set(),
    )  # fmt: skip
    wind: FloatProperty(
        name="Wind",
        description="Speed of the wind over that of the fall: 1 tilts the fall by 45 degrees",
        default=0.0, min=0.0, max=dust.MOST_WIND, soft_max=3.0, step=10, options=set(),
    )  # fmt: skip
    over_frames: BoolProperty(
        name="Over Frames",
        description="Let the amount fall in equal parts at several frames, while objects move. Dust stays "
        "where it settled",
        options=set(),
    )
    frame_first: IntProperty(
        name="First Frame", description="Frame of the first part", default=1, options=set()
    )
    frame_last: IntProperty(
        name="Last Frame", description="Frame of the last part", default=100, options=set()
    )
    frame_step: IntProperty(
        name="Step", description="Frames between two parts", default=10, min=1, options=set()
    )
    seed: IntProperty(name="Seed", description="Seed of the noise and the patches", min=0, options=set())
    others: BoolProperty(
        name="Other Objects",
        description="Objects that are rendered and cast shadows keep dust from this one",
        default=True, options=set(),
    )  # fmt: skip
    stops: BoolProperty(
        name="Keeps Dust Off Others",
        description="Turn off for domes, backdrops and other objects that dust should fall through",
        default=True, options=set(),
    )  # fmt: skip
    target: EnumProperty(name="Stored In", description="Where the dust is kept", items=TARGETS, options=set())
    size: IntProperty(
        name="Size", description="Width and height of the image", default=1024, min=16, max=8192,
        options=set(),
    )  # fmt: skip
    uv_map: StringProperty(name="UV Map", description="Empty: the active one for rendering", options=set())
    image: PointerProperty(type=bpy.types.Image, description="The image that holds the dust, if any")
    # The last report
    told: StringProperty(description="The report in words; empty before the first settling")
    largest: FloatProperty(description="The largest optical thickness")
    largest_back: FloatProperty(description="The largest optical thickness on back faces")


def register():
    bpy.utils.register_class(LaminaDust)
    bpy.types.Object.lamina_dust = PointerProperty(type=LaminaDust, name="Lamina Dust")


def unregister():
    del bpy.types.Object.lamina_dust
    bpy.utils.unregister_class(LaminaDust)

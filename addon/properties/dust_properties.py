# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of an object's dust: how it falls, how much stays, where it is stored, and the last report.

The options of the settling come from `kinds.dust`. A .blend file stores the number of a choice: numbers and
defaults never change, new ones are only added.
"""

import dataclasses
import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..base import changes
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

FRAMES = (
    ("accumulate", "Accumulate", "Dust falls in equal parts at these frames and stays where it settled", 0),
    ("follow", "Follow", "Dust settles anew at each of these frames, and is blended between them", 1),
)

_EDITED = {"options": set(), "update": changes.dust_edited}
_DEFAULTS = {member.name: member.default for member in dataclasses.fields(dust.Settling)}


@having({one.name: dust_number(one, _DEFAULTS[one.name]) for one in dust.OPTIONS if one.panel})
class LaminaDust(bpy.types.PropertyGroup):
    form: EnumProperty(
        name="Amount By", description="Whether the amount is a thickness or a mass", items=FORMS,
        **_EDITED,
    )  # fmt: skip
    substance: EnumProperty(
        name="Dust", description="The kind of dust: its mass extinction", items=SUBSTANCES, **_EDITED
    )
    wind_from: FloatProperty(
        name="Wind From",
        description="Where the wind blows from, counted from the X axis towards Y",
        subtype="ANGLE", default=0.0, min=math.radians(-360.0), max=math.radians(360.0), **_EDITED,
    )  # fmt: skip
    wind: FloatProperty(
        name="Wind",
        description="Speed of the wind over that of the fall: 1 tilts the fall by 45 degrees",
        default=0.0, min=0.0, max=dust.MOST_WIND, soft_max=3.0, step=10, **_EDITED,
    )  # fmt: skip
    over_frames: BoolProperty(
        name="Over Frames",
        description="Let dust settle at several frames, while objects move",
        **_EDITED,
    )
    frames_as: EnumProperty(
        name="Dust", description="What dust does from frame to frame", items=FRAMES, **_EDITED
    )
    frame_first: IntProperty(
        name="First Frame", description="The first frame at which dust settles", default=1, **_EDITED
    )
    frame_last: IntProperty(
        name="Last Frame", description="Dust settles at no later frame", default=100, **_EDITED
    )
    frame_step: IntProperty(
        name="Frame Step", description="Frames from one settling to the next", default=10, min=1, **_EDITED
    )
    seed: IntProperty(name="Seed", description="Seed of the noise and the patches", min=0, **_EDITED)
    others: BoolProperty(
        name="Other Objects",
        description="Objects that are rendered and cast shadows keep dust from this one",
        default=True, **_EDITED,
    )  # fmt: skip
    stops: BoolProperty(
        name="Keeps Dust Off Others",
        description="Turn off for domes, backdrops and other objects that dust should fall through",
        default=True, options=set(),
    )  # fmt: skip
    target: EnumProperty(name="Stored In", description="Where the dust is kept", items=TARGETS, **_EDITED)
    size: IntProperty(
        name="Size", description="Width and height of the image", default=1024, min=16, max=8192,
        subtype="PIXEL",
        **_EDITED,
    )  # fmt: skip
    uv_map: StringProperty(name="UV Map", description="Empty: the active one for rendering", **_EDITED)
    live: BoolProperty(
        name="Settle by Itself",
        description="Settle again by itself while these settings change: with few rays at first, then with "
        "all. Shows the present frame",
        options=set(),
        update=changes.dust_switched,
    )
    image: PointerProperty(type=bpy.types.Image, description="The image that holds the dust, if any")
    # The last report
    told: StringProperty(description="The report in words; empty before the first settling")
    settled: StringProperty(description="The settings of the last settling, see dust_settings.text")
    largest: FloatProperty(description="The largest optical thickness")
    largest_back: FloatProperty(description="The largest optical thickness on back faces")


def register():
    bpy.utils.register_class(LaminaDust)
    bpy.types.Object.lamina_dust = PointerProperty(type=LaminaDust, name="Lamina Dust")


def unregister():
    del bpy.types.Object.lamina_dust
    bpy.utils.unregister_class(LaminaDust)

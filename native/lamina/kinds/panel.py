# SPDX-License-Identifier: GPL-3.0-or-later
"""How Blender's panel shows a field. Plain data: the add-on makes properties and rows of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Panel:
    """A field as a property. What is None is left to Blender.

    `label`, `tip`: the property's name and tooltip. `default`: a number, or three where `rgb`. `low`, `high`: where
    the property ends, if inside the field's range; `soft_high`: where its slider ends. `rgb`: one number per channel;
    `subtype`: Blender's, such as COLOR or ANGLE. `text`: the label in the panel, if another. `slider`: drawn as one.
    `prop`: the property's name in .blend files, if not the field's. `words`: the field in sentences to the user."""

    label: str
    tip: str
    default: float | tuple[float, float, float] | None = None
    low: float | None = None
    high: float | None = None
    soft_low: float | None = None
    soft_high: float | None = None
    step: int | None = None
    precision: int | None = None
    subtype: str | None = None
    rgb: bool = False
    text: str = ""
    slider: bool = True
    prop: str = ""
    words: str = ""


@dataclass(frozen=True)
class Item:
    """One entry of a list of choices. .blend files keep `number`: a number never changes, new ones are added.

    `id`: the kind's name in JSON. `words`: the kind in sentences to the user, if not `label`."""

    id: str
    label: str
    tip: str
    number: int
    icon: str = ""
    words: str = ""

    @property
    def entry(self) -> tuple:
        """As bpy.props.EnumProperty takes it."""
        icon = (self.icon,) if self.icon else ()
        return (self.id, self.label, self.tip, *icon, self.number)

# SPDX-License-Identifier: GPL-3.0-or-later
"""How Blender's panel shows a field. Plain data, from which the add-on makes properties and rows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Panel:
    """A field as a property. Blender's defaults replace None.

    `label`, `tip`: the property's name and tooltip. `default`: a number, or three with `rgb`. `low`, `high`: ends of
    the property's range, if inside the field's; `soft_high`: end of its slider. `rgb`: one number per channel;
    `subtype`: Blender's, such as COLOR or ANGLE. `text`: the label in the panel, if it differs. `slider`: drawn as a
    slider. `prop`: the property's name in .blend files, if not the field's. `words`: the field's name in messages to
    the user. `percent`: the property is in percent, so its default and range are 100 times the field's."""

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
    percent: bool = False


@dataclass(frozen=True)
class Item:
    """One entry of a list of choices. .blend files store `number`: a number never changes, new ones are added.

    `id`: the kind's name in JSON. `words`: the kind's name in messages to the user, if not `label`."""

    id: str
    label: str
    tip: str
    number: int
    icon: str = ""
    words: str = ""

    @property
    def entry(self) -> tuple:
        """The tuple for bpy.props.EnumProperty."""
        icon = (self.icon,) if self.icon else ()
        return (self.id, self.label, self.tip, *icon, self.number)

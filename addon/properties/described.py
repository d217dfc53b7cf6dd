# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender properties made of the descriptions in `kinds`."""

from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from ..base import changes
from ..base.decimals import shortest
from ..kinds.fields import Option
from ..kinds.measured import TableText

# Attributes of a Panel, and Blender's names for them.
_MORE = {
    "soft_min": "soft_low",
    "soft_max": "soft_high",
    "step": "step",
    "precision": "precision",
    "subtype": "subtype",
}


def having(properties):
    """A class decorator that adds these properties, given as {name: property}. Raises ValueError if the class
    has one of the names already.

    Not done by statements in the class body, where Python 3.14 no longer has `__annotations__`."""

    def decorate(cls):
        if taken := properties.keys() & cls.__annotations__.keys():
            names = ", ".join(sorted(taken))
            raise ValueError(f"{cls.__name__} has a property of this name already: {names}")
        cls.__annotations__ = {**cls.__annotations__, **properties}
        return cls

    return decorate


def number(field, update=changes.edited):
    """The property of a Field: a number, or three if its panel says rgb."""
    default = field.panel.default
    if field.whole:
        return IntProperty(default=default, **_settings(field, update))
    if not field.panel.rgb:
        return FloatProperty(default=_shown(field, default), **_settings(field, update))
    default = default if isinstance(default, tuple) else (default,) * 3
    return FloatVectorProperty(size=3, default=default, **_settings(field, update))


def quantities(fields, update=changes.edited):
    """{name: property} of several Fields and Options. Raises ValueError if two that differ have one name."""
    by_name = {}
    for field in fields:
        if by_name.setdefault(field.prop, field) != field:
            raise ValueError(f"two properties are named {field.prop}: {by_name[field.prop]}, {field}")
    return {
        name: option(field) if isinstance(field, Option) else number(field, update)
        for name, field in by_name.items()
    }


def per_channel(field, description, update=changes.edited):
    """The property with red, green and blue beside the property of a Field with one number."""
    settings = {**_settings(field, update), "description": description}
    return FloatVectorProperty(size=3, default=(field.panel.default,) * 3, **settings)


def dust_number(option, default):
    """The property of a DustOption; `default`: that of Settling, unless the panel has its own."""
    panel = option.panel
    default = default if panel.default is None else panel.default
    if option.switch:
        return BoolProperty(name=panel.label, description=panel.tip, default=default, options=set(),
                            update=changes.dust_edited)
    kind = IntProperty if option.whole else FloatProperty
    return kind(default=default, **_settings(option, changes.dust_edited))


def choice(name, items, description, default=None, update=changes.edited):
    """A list of choices; `items` as Blender expects them."""
    default = items[0][0] if default is None else default
    return EnumProperty(
        name=name, description=description, items=items, default=default, update=update, options=set()
    )


def text(name, description):
    return StringProperty(name=name, description=description, update=changes.edited, options=set())


def switch(name, description, default=False, update=changes.edited):
    return BoolProperty(name=name, description=description, default=default, update=update, options=set())


def option(described):
    """The property of an Option: a list of choices, of which several may be chosen, a switch, or a table."""
    if isinstance(described, TableText):
        return text(described.label, described.tip)
    if described.several:
        return EnumProperty(
            name=described.label,
            description=described.tip,
            items=entries(described.items),
            default=set(described.usual),
            update=changes.edited,
            options={"ENUM_FLAG"},
        )
    usual = described.values[0]
    if described.items:
        return choice(described.label, entries(described.items), described.tip, usual)
    return switch(described.label, described.tip, usual)


def entries(items):
    """Items as Blender expects them."""
    return tuple(item.entry for item in items)


def _settings(field, update):
    panel = field.panel
    more = {ours: getattr(panel, theirs) for ours, theirs in _MORE.items()}
    more |= {end: _shown(field, more[end]) for end in ("soft_min", "soft_max") if more[end] is not None}
    return {
        "name": panel.label,
        "description": panel.tip,
        "min": _shown(field, field.low if panel.low is None else panel.low),
        "max": _shown(field, field.high if panel.high is None else panel.high),
        "options": set(),
        **{name: value for name, value in more.items() if value is not None},
        **({} if update is None else {"update": update}),
    }


def _shown(field, value):
    """A value of a quantity as the panel shows it: a number, or percent."""
    return 100.0 * value if field.panel.percent else value


def quantity(owner, field):
    """The value of a Field's property: a number, or three, as the shortest decimals."""
    value = getattr(owner, field.prop)
    if field.whole:
        return value
    if field.panel.rgb:
        return tuple(shortest(one) for one in value)
    return shortest(value) / 100.0 if field.panel.percent else shortest(value)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Strips of a table: the names in headers, which tables of earlier versions have too, and what they hold."""

import pytest

from lamina.kinds.table import (
    AGAIN,
    BASE,
    BASE_WEIGHT,
    DARK,
    FIRST,
    OWN,
    PRINCIPLED,
    THROWN_BACK,
    TRAPPED,
    Strip,
    is_covered,
    strips_of,
)

NAMES = {
    "diffuse": ("diffuse", OWN, False),
    "transparent": ("transparent", OWN, False),
    "mirror:0.1": ("mirror:0.1", OWN, False),
    "base/toon:0.1:0.07:0.4": ("toon:0.1:0.07:0.4", BASE, False),
    "metal/ggx:0.15": ("ggx:0.15", OWN, True),
    "metal/base/ggx:0.15": ("ggx:0.15", BASE, True),
    "dark/follows/ggx:1.5:0": ("follows/ggx:1.5:0", DARK, False),
    "first/diffuse": ("diffuse", FIRST, False),
    "metal/again/mirror:0": ("mirror:0", AGAIN, True),
    "base/thrown back": ("", THROWN_BACK, False),
    "metal/base/thrown back": ("", THROWN_BACK, True),
    "base/weight": ("", BASE_WEIGHT, False),
    "principled": ("", PRINCIPLED, False),
    "metal/trapped": ("", TRAPPED, False),
}


@pytest.mark.parametrize("name", NAMES)
def test_a_name_and_its_strip(name):
    assert Strip.of(name) == Strip(*NAMES[name])
    assert Strip.of(name).name == name


@pytest.mark.parametrize("name", ["trapped", "principled?", "base/weight?", "metal/", "metal/metal/diffuse"])
def test_other_names_are_those_of_unknown_closures(name):
    assert Strip.of(name).name == name
    assert Strip.of(name).closure in (name, name.removeprefix("base/"), name.removeprefix("metal/"))


def test_a_covered_base_has_dark_strips():
    assert strips_of({"closures": ["diffuse", "metal/dark/diffuse"]}) == [
        Strip("diffuse"), Strip("diffuse", DARK, True)]
    assert is_covered([Strip("diffuse"), Strip("diffuse", DARK, True)])
    assert not is_covered([Strip("diffuse"), Strip("diffuse", BASE)])

# SPDX-License-Identifier: GPL-3.0-or-later
"""A layer from its colors over black and over white."""

from dataclasses import replace

import bpy
import pytest
from addon_helpers import drawn_layer


def test_a_layer_shows_both_colors(addon, lamina, material, call):
    dark, bright = (0.2, 0.1, 0.05), (0.6, 0.5, 0.3)
    assert call(bpy.ops.lamina.match_colors, material, over_black=dark, over_white=bright) == {"FINISHED"}
    layer = addon.editing.stack_io.to_stack(material).layers[0]
    assert lamina.colours.shown(layer, 0.0) == pytest.approx(dark, rel=1e-4)
    assert lamina.colours.shown(layer, 0.8) == pytest.approx(bright, rel=1e-4)
    assert "Match Two Colors..." in drawn_layer(addon, material.lamina.layers[0])


def test_a_layer_shows_one_coat_and_two(addon, lamina, material, call):
    known = {"once": (0.3, 0.5, 0.4), "twice": (0.4, 0.4, 0.5), "over": (0.1, 0.7, 0.2)}
    assert call(bpy.ops.lamina.match_colors, material, known="COATS", **known) == {"FINISHED"}
    coat = addon.editing.stack_io.to_stack(material).layers[0]
    for times, name in ((1.0, "once"), (2.0, "twice")):
        layer = replace(coat, tau=tuple(times * tau for tau in coat.tau))
        for channel in range(3):
            assert lamina.colours.shown(layer, known["over"])[channel] == pytest.approx(known[name][channel], rel=1e-4)


def test_a_layer_that_hides_the_base_in_one_channel(addon, material):
    layer = material.lamina.layers[0]
    addon.editing.matched_colors.match(layer, (0.4, 0.1, 0.1), (0.4, 0.5, 0.5), 0.8)
    assert not layer.infinite and layer.tau_rgb[0] == 100.0 and layer.tau_rgb[1] < 2.0
    addon.editing.matched_colors.match(layer, (0.4, 0.3, 0.2), (0.4, 0.3, 0.2), 0.8)
    assert layer.infinite


def test_what_cannot_be_matched_changes_nothing(addon, material, call):
    before = addon.editing.stack_io.to_dict(material)
    with pytest.raises(RuntimeError, match=r"^Error: Over Black \(red\) = 0.5: must be at most Over White, 0.4"):
        call(bpy.ops.lamina.match_colors, material, over_black=(0.5, 0.5, 0.5), over_white=(0.4, 0.5, 0.5))
    words = r"^Error: Over Black \(red\) = 0: a layer that shows 0.8 over 0.8 shows at least [\d.e-]+ over black\.?\s*$"
    with pytest.raises(RuntimeError, match=words):
        call(bpy.ops.lamina.match_colors, material, over_black=(0.0, 0.1, 0.1), over_white=(0.8, 0.8, 0.8))
    words = r"^Error: Several Coats \(red\) = 0.2: a coat that shows 0.9 over 1 shows at least"
    with pytest.raises(RuntimeError, match=words):
        call(bpy.ops.lamina.match_colors, material, known="COATS", once=(0.9, 0.9, 0.9), twice=(0.2, 0.9, 0.9),
             over=(1.0, 1.0, 1.0), times=1.05)
    with pytest.raises(RuntimeError, match="must lie beyond One Coat, 0.3, as seen from Surface, 0.1"):
        call(bpy.ops.lamina.match_colors, material, known="COATS", once=(0.3,) * 3, twice=(0.2,) * 3, over=(0.1,) * 3)
    assert addon.editing.stack_io.to_dict(material) == before
    material.lamina.layers[0].graded = True
    assert not call(bpy.ops.lamina.match_colors.poll, material)
    with pytest.raises(addon.base.messages.RefusedError, match="does not change with depth"):
        addon.editing.matched_colors.match(material.lamina.layers[0], (0.1,) * 3, (0.2,) * 3, 0.8)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Brushes that wipe: finger marks and streaks."""

import bpy
import numpy as np
import pytest

MODES = {"TEXTURE_PAINT": "image_paint", "VERTEX_PAINT": "vertex_paint"}


@pytest.fixture(params=MODES)
def paint(request):
    bpy.ops.mesh.primitive_plane_add()
    bpy.ops.object.mode_set(mode=request.param)
    yield getattr(bpy.context.tool_settings, MODES[request.param])
    bpy.ops.object.mode_set(mode="OBJECT")


def test_each_stamp_becomes_the_active_brush_and_is_made_once(addon, paint):
    stamps = addon.settling.stamps
    assert stamps.chosen(bpy.context) == ""
    for _ in range(2):
        for key, stamp in stamps.STAMPS.items():
            assert bpy.ops.lamina.stamp(stamp=key) == {"FINISHED"}
            assert stamps.chosen(bpy.context) == key
            assert (paint.brush.texture is None) == (key == "PLAIN")
            assert paint.brush.name.startswith(f"Wipe: {stamp.name}")
    ours = [brush for brush in bpy.data.brushes if stamps.MARK in brush]
    assert len(ours) == len(stamps.STAMPS)


def test_stamps_are_white_and_end_within_their_images(addon):
    """Black texels would bring the layer back, and an alpha at the edge would show the image's square."""
    for key, stamp in addon.settling.stamps.STAMPS.items():
        texels = stamp.texels()
        assert np.all(texels[..., :3] == 1.0)
        alpha = texels[..., 3]
        assert alpha.min() >= 0.0 and alpha.max() <= 1.0 and alpha.max() > 0.7
        if key != "PLAIN":
            assert 0.1 < alpha.mean() < 0.7
            edge = np.concatenate([alpha[0], alpha[-1], alpha[:, 0], alpha[:, -1]])
            assert edge.max() < 0.05


def test_stamps_need_paint_mode(addon):
    bpy.ops.mesh.primitive_plane_add()
    assert not bpy.ops.lamina.stamp.poll()
    with pytest.raises(addon.base.messages.RefusedError, match="paint mode"):
        addon.settling.stamps.choose(bpy.context, "FINGER")

# SPDX-License-Identifier: GPL-3.0-or-later
"""The result as pictures: made by each bake, kept in the file, drawn in the colors of the theme."""

import json
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from addon_helpers import drawn


def context_of(material, ink=(0.9, 0.9, 0.9), width=320):
    theme = SimpleNamespace(user_interface=SimpleNamespace(wcol_regular=SimpleNamespace(text=ink)))
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0), themes=[theme])
    return SimpleNamespace(preferences=preferences, material=material, region=SimpleNamespace(width=width))


def lines(addon, material, **options):
    """The texts of the state and of the panel Advanced."""

    def draw(layout):
        context = context_of(material, **options)
        addon.ui.state_line.draw(context, layout, material)
        addon.ui.advanced_panel.LAMINA_PT_advanced.draw(SimpleNamespace(layout=layout), context)

    return drawn(draw)


def pixels_of(addon, number):
    picture = addon.ui.result_picture
    (entry,) = (one for (_uid, kind), one in picture._shown.items() if kind == "lobes")
    preview = picture._pictures[entry[4][number]]
    return np.array(preview.image_pixels_float).reshape(*reversed(tuple(preview.image_size)), 4)


def test_a_bake_is_shown_as_pictures_and_the_numbers_are_folded(addon, lamina, material):
    addon.baking.bake_job.bake_material(material)
    texts = lines(addon, material)
    assert texts.count("(picture)") == 5
    assert [text for text in texts if text.startswith("View")] == ["View 0°", "View 40°", "View 70°"]
    fold = next(place for place, text in enumerate(texts) if text.startswith("Numbers"))
    assert texts.index("Fit Error") > fold > texts.index("Reflectance, 0° to 90°")


def test_the_pixels_are_those_of_lamina_in_the_color_of_the_text(addon, lamina, material):
    addon.baking.bake_job.bake_material(material)
    curves = json.loads(material.lamina.result.curves)
    for ink in ((0.9, 0.9, 0.9), (0.1, 0.1, 0.1)):
        lines(addon, material, ink=ink)
        found = pixels_of(addon, 0)
        expected = addon.base.native.part("baking.report.result_picture").lobe_picture(curves, 0, len(found), ink)
        expected[..., :3] *= expected[..., 3:]
        assert found == pytest.approx(expected, abs=1.0 / 255.0)
        assert found[..., 3].max() == 1.0 and found[0, 0, 3] == 0.0
    lines(addon, material, ink=(0.1, 0.1, 0.1))
    assert len(addon.ui.result_picture._pictures) == 5, "outdated pictures are removed"
    small = len(found)
    lines(addon, material, width=560)
    assert len(pixels_of(addon, 0)) > small, "a wide editor has larger pictures"


def test_the_picture_survives_save_and_load_without_an_image(addon, lamina, material, tmp_path):
    material.use_fake_user = True
    addon.baking.bake_job.bake_material(material)
    images, before = len(bpy.data.images), lines(addon, material)
    curves = material.lamina.result.curves
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shown.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shown.blend"))
    material = bpy.data.materials["Bronze"]
    assert material.lamina.result.curves == curves and lines(addon, material) == before
    assert len(bpy.data.images) == images
    assert [path.name for path in tmp_path.iterdir()] == ["shown.blend"]


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"views": [0]}', '{"views": 3}'])
def test_a_bake_of_another_version_shows_its_numbers(addon, lamina, material, text):
    addon.baking.bake_job.bake_material(material)
    material.lamina.result.curves = text
    texts = lines(addon, material)
    assert "(picture)" not in texts and "Fit Error" in texts
    assert not any(line.startswith("Numbers") for line in texts)


def test_the_worker_makes_the_same_curves(addon, lamina, material):
    other = material.copy()
    addon.baking.bake_job.bake_material(material)
    job = addon.baking.bake_job.start(other)
    job.wait()
    assert job.finish() == other
    addon.baking.bake_job.forget()
    assert other.lamina.result.curves == material.lamina.result.curves


def test_nothing_undoes_portal_or_relightable(addon, lamina, material):
    """While they are shown, the bake is not connected on purpose: no button that connects it."""
    addon.baking.bake_job.bake_material(material)

    def draw(graph, _length, _sockets):
        return graph.node("ShaderNodeBsdfDiffuse").outputs[0], None

    addon.nodes.lateral_group.build(material, "Portal", draw, 0.001)
    texts = " ".join(lines(addon, material))
    assert "shows light below the surface" in texts and "Not connected" not in texts
    addon.nodes.node_group.connect(material)
    assert "shows light below the surface" not in " ".join(lines(addon, material))

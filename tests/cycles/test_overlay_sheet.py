# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheet of overlays over ten materials: the materials, and the layout."""

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "demo_scenes"))
from presets import overlays


def test_materials_lie_below_layers(addon):
    """Layers can lie over each: as a Principled base, or over the shader as it is."""
    for name, values, texture in overlays.MATERIALS:
        material = overlays.made(name, values, texture)
        shader = addon.nodes.principled.find(material)
        for socket, value in values.items():
            found = shader.inputs[socket].default_value
            given = found if isinstance(value, float) else tuple(found)[:3]
            assert given == pytest.approx(value), (name, socket)
        assert shader.inputs["Base Color"].is_linked == (texture is not None)


def test_rows_are_overlays_and_columns_are_materials(tmp_path):
    columns = len(overlays.MATERIALS)
    cells = [np.full((8, 8, 3), 10 * number, np.uint8) for number in range(2 * columns)]
    overlays.sheet(tmp_path / "sheet.png", ["Dust", "Snow"], cells)
    found = np.asarray(Image.open(tmp_path / "sheet.png"))
    for number in (0, columns - 1, columns, 2 * columns - 1):
        row, column = divmod(number, columns)
        assert found[overlays.TITLES + 8 * row + 4, overlays.NAMES + 8 * column + 4, 0] == 10 * number

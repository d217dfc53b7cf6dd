# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures for notebooks: valid SVG without other packages, with the layers in order and in their colours."""

import math
import re
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import lamina
from lamina import Interface, Lambert, Medium, Stack

SVG = "{http://www.w3.org/2000/svg}"


def drawn(thing):
    return ElementTree.fromstring(thing._repr_html_())


def test_layers_are_drawn_from_the_top():
    stack = Stack([Interface(1.5, 0.1), Medium([0.99, 0.8, 0.2], 3.0, name="red <paint>"), Medium(0.5, 0.01)],
                  Lambert(1.0), name="Test")
    boxes = drawn(stack).findall(f"{SVG}rect")
    assert len(boxes) == 4
    tops, heights = ([float(box.get(name)) for box in boxes] for name in ("y", "height"))
    assert tops == sorted(tops) and heights[1] > 2.0 * heights[2]  # the thicker medium is drawn thicker
    red, green, blue = (int(boxes[1].get("fill")[k:k + 2], 16) for k in (1, 3, 5))
    shown = lamina.colours.shown(Medium([0.99, 0.8, 0.2], math.inf))
    assert red > green > blue and red == pytest.approx(255 * (1.055 * shown[0] ** (1 / 2.4) - 0.055), abs=1)
    assert boxes[3].get("fill") == "#ffffff"
    words = [text.text for text in drawn(stack).findall(f"{SVG}text")]
    assert words[0] == "Test" and "red <paint>: medium, tau 3" in words


@pytest.mark.parametrize("preset", ["gold", "skin-three-layers", "snow-fresh", "leaf", "silted-pond", "car-paint-red"])
def test_presets_have_pictures(preset):
    stack = lamina.presets.load(preset)
    boxes = drawn(stack).findall(f"{SVG}rect")
    assert len(boxes) == len(stack.layers) + (stack.base is not None)
    assert all(re.fullmatch("#[0-9a-f]{6}", box.get("fill")) for box in boxes)


@pytest.mark.parametrize(("stack", "lines"), [
    (Stack([Medium([0.9, 0.8, 0.6], 1.0)], Lambert([0.5, 0.3, 0.1])), 9), (Stack([Medium(0.9, 1.0)]), 6)])
def test_a_table_is_drawn_by_its_lobes(stack, lines, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    lut = lamina.bake(stack, "preview")
    horizon, *found = drawn(lut).findall(f"{SVG}polyline")
    assert len(found) == lines
    points = [np.array([pair.split(",") for pair in line.get("points").split()], float) for line in found]
    level, middle = float(horizon.get("points").split(",")[1].split()[0]), float(drawn(lut).get("width")) / 2
    reach = max(np.hypot(one[:, 0] - middle, one[:, 1] - level).max() for one in points)
    assert reach == pytest.approx(150.0, abs=0.2)
    if lines == 9:  # the first line is red seen along the normal; straight up is light from there
        up = level - np.interp(middle, points[0][:, 0], points[0][:, 1])
        across = np.linspace(0.0, 1.0, 40)[1:, None]
        most = max((lut.evaluate(mu, across, [0.0, np.pi])[..., c] * across).max()
                   for mu in (1.0, math.sqrt(0.5), 0.3) for c in range(3))
        assert up / 150.0 == pytest.approx(lut.evaluate(1.0, 1.0, 0.0)[0] / most, rel=0.03)

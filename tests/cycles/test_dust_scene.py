# SPDX-License-Identifier: GPL-3.0-or-later
"""The dust demo: its shell has the stated thickness, and the baked dust agrees with it."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "demo_scenes"))

from dust import scene, shell  # noqa: E402


@pytest.mark.parametrize("name", shell.SHAPES)
def test_a_shape_is_closed_and_its_normals_point_outward(name):
    corners, faces = shell.SHAPES[name](0.0)
    edges = [(face[k - 1], face[k]) for face in faces for k in range(len(face))]
    assert len(set(edges)) == len(edges) and all((b, a) in set(edges) for a, b in edges[:2000])
    volume = sum(np.linalg.det(np.stack([corners[face[0]], corners[face[k]], corners[face[k + 1]]]))
                 for face in faces for k in range(1, len(face) - 1)) / 6.0
    expected = {"sphere": 4.0 / 3.0 * np.pi * shell.RADIUS**3, "steps": 1.8 * (2.2 * 0.55 + 1.45 * 0.55 + 0.7 * 0.55)}
    assert volume == pytest.approx(expected[name], rel=2e-3)


def test_the_shell_is_equally_thick_everywhere():
    for name, shape in shell.SHAPES.items():
        inner, faces = shape(0.0)
        outer, _ = shape(scene.THICKNESS)
        for face in faces[:: max(1, len(faces) // 500)]:
            ring = inner[list(face)]
            normal = np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)  # Newell's: faces may be concave
            normal /= np.linalg.norm(normal)
            heights = (outer[list(face)] - ring[0]) @ normal
            assert heights == pytest.approx(np.full(len(face), scene.THICKNESS), rel=2e-3), name


@pytest.mark.parametrize("change", [{"varying": False}, None])
def test_a_stack_that_cannot_be_shown_is_refused_in_a_sentence(tmp_path, change):
    stack = scene.load_stack()
    if change is None:
        stack["layers"].append({**stack["layers"][0], "varying": False})
    else:
        stack["layers"][0].update(change)
    path = tmp_path / "stack.json"
    path.write_text(json.dumps(stack))
    with pytest.raises(ValueError, match="varies"):
        scene.load_stack(path)


def test_the_demo_makes_its_files_and_the_shell_agrees(demo, tmp_path):
    facts, _ = demo("dust")
    for body in facts["bodies"].values():
        noise = np.hypot(body["sigma_truth"], body["sigma_baked"])
        allowed = 3.0 * noise + (body["fit_error"] + body["geometry_error"]) * body["mean_truth"]
        assert abs(body["mean_baked"] - body["mean_truth"]) < allowed
        assert noise < 0.02 * body["mean_truth"], "too noisy to say anything"
    assert facts["bodies"]["sphere"]["geometry_error"] == scene.CURVATURE
    with Image.open(tmp_path / "dust.png") as picture:
        assert picture.width > 3 * facts["width"]

# SPDX-License-Identifier: GPL-3.0-or-later
"""The dragon is closed; other meshes can replace it; the scene renders."""

import gzip
import json
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from needs_embree import with_embree

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "demo_scenes"))

import cycles_render  # noqa: E402
import extension  # noqa: E402
import mesh_file  # noqa: E402
from dragon import demo, plinth, scene  # noqa: E402

# Half a cube as Stanford writes: y up, vertices of no face, open.
PLY = """ply
format ascii 1.0
element vertex 8
property float x
property float y
property float z
element face 3
property list uchar int vertex_indices
end_header
9 9 9
1 5 -1
1 5 1
3 5 1
3 5 -1
1 8 -1
1 8 1
-7 0 2
4 1 2 3 4
3 1 5 6
3 1 6 2
"""


def _is_closed(vertices, sizes, corners):
    """Whether each edge has two faces, turned alike."""
    last = np.cumsum(sizes) - 1
    following = np.arange(len(corners)) + 1
    following[last] = last + 1 - sizes
    forth, back = (np.sort(a * len(vertices) + b) for a, b in ((corners, corners[following]),
                                                               (corners[following], corners)))
    return np.all(np.diff(forth) > 0) and np.array_equal(forth, back)


def test_the_dragon_is_closed_and_fine():
    vertices, sizes, corners = mesh_file.read(scene.DRAGON)
    assert _is_closed(vertices, sizes, corners)
    assert len(sizes) >= 200_000
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    assert 200.0 < high[2] - low[2] < 300.0 and -2.0 < low[2] < 1.0  # mm


def test_the_plinth_is_closed():
    vertices, quads, triangles = plinth.build(50.0, 2.0)
    sizes = np.repeat((4, 3), (len(quads), len(triangles)))
    assert _is_closed(vertices, sizes, np.concatenate([quads.ravel(), triangles.ravel()]))


def test_a_file_stands_upright_on_the_plinth(tmp_path):
    path = tmp_path / "half.ply"
    path.write_text(PLY)
    vertices, sizes, corners = mesh_file.upright(path, 0.3, 0.2)
    assert sizes.tolist() == [4, 3, 3] and len(vertices) == 6 and corners.max() == 5
    # 2 x 3 x 2 with y up: the height limits the scale.
    assert vertices.min(axis=0) == pytest.approx((-1 / 15, -1 / 15, 0.0), abs=1e-6)
    assert vertices.max(axis=0) == pytest.approx((1 / 15, 1 / 15, 0.2), abs=1e-6)
    assert np.ptp(mesh_file.upright(path, 0.1, 0.2, up="z")[0], axis=0)[1] == pytest.approx(0.1)
    assert not [thing for thing in bpy.data.objects if thing.name.startswith("half")]


OBJ = """v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
v 5 5 5
f 1 3 2
f 1 2 4
f 2 3 4
cstype bezier
deg 3
curv 0 1 1 2 3 5
parm u 0 1
end
"""


def test_curves_of_a_file_are_left_out(tmp_path):
    path = tmp_path / "curve.obj"
    path.write_text(OBJ)
    before = set(bpy.data.objects), len(bpy.data.curves), len(bpy.data.meshes)
    vertices, sizes, _ = mesh_file.upright(path, 0.3, 0.2, up="z")
    assert len(vertices) == 4 and sizes.tolist() == [3, 3, 3]
    assert (set(bpy.data.objects), len(bpy.data.curves), len(bpy.data.meshes)) == before


def test_a_packed_file_is_what_it_packs(tmp_path):
    plain, packed = tmp_path / "half.ply", tmp_path / "half.ply.gz"
    plain.write_text(PLY)
    packed.write_bytes(gzip.compress(PLY.encode(), mtime=0))
    for one, other in zip(mesh_file.upright(plain, 0.3, 0.2), mesh_file.upright(packed, 0.3, 0.2), strict=True):
        assert np.array_equal(one, other)
    damaged = bytearray(packed.read_bytes())
    damaged[40] ^= 255
    packed.write_bytes(damaged)
    with pytest.raises(ValueError, match="half.ply.gz: is a damaged gzip file") as caught:
        mesh_file.upright(packed, 0.3, 0.2)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("name", "text", "says"), [
    ("none.ply", None, "no such file"),
    ("dragon.txt", "", "must end in"),
    ("dragon.txt.gz", "", "must end in"),
    ("points.ply", PLY.replace("element face 3", "element face 0").rsplit("4 1 2", 1)[0], "no faces"),
    ("flat.ply", PLY.replace("1 8 ", "1 5 "), "no height"),
])
def test_a_bad_file_is_refused_in_a_sentence(tmp_path, name, text, says):
    path = tmp_path / name
    if text is not None:
        path.write_text(text)
    with pytest.raises(ValueError, match=says):
        mesh_file.upright(path, 0.3, 0.2)


@with_embree
def test_the_scene_renders_cleaner_and_dustier(tmp_path, addon, monkeypatch):
    monkeypatch.setattr(extension, "PACKAGE", addon.__name__)
    base = {**demo.load_stack(demo.STACK), "base": {"kind": "lambert", "reflectance": 0.05}}
    quick = tmp_path / "stack.json"
    quick.write_text(json.dumps({**base, "layers": base["layers"][:1]}))
    files, verdict, well = demo.run(tmp_path, "tiny", quick, print)
    assert well, verdict
    assert all(path.stat().st_size > 1000 for path in files)
    facts = json.loads((tmp_path / "dragon.json").read_text())
    assert facts["dust"]["figure"]["mean"] > 0.0 and set(facts["seconds"]) >= {"mesh", "bake", "dust", "render"}
    picture = cycles_render.read(str(files[0]))
    width = picture.shape[1] // 3
    # Pale dust over a dark base: the middle of each third, where the figure stands.
    means = [picture[20:80, k * width + 18 : k * width + 46].mean() for k in range(3)]
    assert means[0] < means[1] < means[2]


def test_a_stack_without_dust_is_refused(addon, monkeypatch):
    monkeypatch.setattr(extension, "PACKAGE", addon.__name__)
    stack = demo.load_stack(demo.STACK)
    with pytest.raises(ValueError, match="varying"):
        scene.material({**stack, "layers": stack["layers"][1:]}, "preview", 8)

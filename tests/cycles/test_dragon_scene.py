# SPDX-License-Identifier: GPL-3.0-or-later
"""The dragon is closed and reproducible; other meshes can replace it; the scene renders."""

import gzip
import hashlib
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
from dragon import demo, mesh_file, plinth, scene, sculpture, shells, splines, surface_nets  # noqa: E402

ROUGHLY = (3.2, 1.8)  # mm: a grid that is quick
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


@pytest.fixture(scope="module")
def dragon():
    """As `make demo` shows it."""
    return sculpture.build(*scene.COARSE)


@pytest.fixture(scope="module")
def rough_dragon():
    return sculpture.build(*ROUGHLY)


def _uses_of_edges(quads, triangles):
    """How many faces each edge has, and how many run along it in its one direction."""
    starts = np.concatenate([quads.ravel(), triangles.ravel()])
    ends = np.concatenate([np.roll(quads, -1, axis=1).ravel(), np.roll(triangles, -1, axis=1).ravel()])
    count = int(starts.max()) + 1
    key = np.minimum(starts, ends) * count + np.maximum(starts, ends)
    _, number, uses = np.unique(key, return_inverse=True, return_counts=True)
    return uses, np.bincount(number.ravel(), starts < ends)


def _volume(vertices, quads, triangles):
    three = np.concatenate([triangles, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    a, b, c = (vertices[three[:, k]] for k in range(3))
    return np.sum(np.einsum("ij,ij->i", a, np.cross(b, c))) / 6.0


def test_the_dragon_is_closed_and_fine(dragon):
    vertices, quads, triangles = dragon
    assert len(quads) + len(triangles) >= 200_000
    assert np.isfinite(vertices).all()
    uses, forth = _uses_of_edges(quads, triangles)
    assert np.all(uses == 2)
    assert np.all(forth == 1), "neighbouring faces are turned alike"
    assert len(np.unique(np.concatenate([quads.ravel(), triangles.ravel()]))) == len(vertices)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    assert 200.0 < high[2] - low[2] < 300.0 and -2.0 < low[2] < 1.0


def test_the_dragon_is_the_same_each_time(rough_dragon):
    first, second = (hashlib.sha256(b"".join(part.tobytes() for part in made)).hexdigest()
                     for made in (rough_dragon, sculpture.build(*ROUGHLY)))
    assert first == second


def test_each_shell_of_the_dragon_is_turned_outwards(rough_dragon):
    for shell in (shells.spike((1, 2, 3), (0, 1, 1), (3, 0, 0), 10, 2), plinth.build(50.0, 2.0),
                  shells.sheet(np.stack([*np.meshgrid(range(5), range(7), indexing="ij"), np.zeros((5, 7))], -1), 0.5),
                  shells.swept(splines.curve([(0, 0, 0), (1, 5, 2), (3, 9, 2)], (0, 0, 1), np.full((3, 2), 1.0)))):
        uses, forth = _uses_of_edges(*shell[1:])
        assert np.all(uses == 2) and np.all(forth == 1)
        assert _volume(*shell) > 0.0
    assert _volume(*rough_dragon) > 0.0


def test_surface_nets_find_a_ball():
    radius = 7.0
    vertices, quads = surface_nets.mesh(lambda p, reach: np.linalg.norm(p, axis=1) - radius, [(-8,) * 3, (8,) * 3], 0.5)
    uses, _ = _uses_of_edges(quads, np.empty((0, 3), int))
    assert np.all(uses == 2)
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(radius, abs=0.02)
    assert _volume(vertices, quads, np.empty((0, 3), int)) == pytest.approx(4.0 / 3.0 * np.pi * radius**3, rel=0.01)


def test_surface_nets_stay_closed_where_signs_alternate():
    noise = np.random.default_rng(1).normal(size=(40, 40, 40))

    def distance(points, reach):
        return noise[tuple(np.clip(np.round(points).astype(int) + 8, 0, 39).T)]

    _, quads = surface_nets.mesh(distance, [(0,) * 3, (16,) * 3], 1.0, relaxations=0)
    uses, _ = _uses_of_edges(quads, np.empty((0, 3), int))
    assert len(quads) > 1000 and np.all(uses == 2)


def test_a_file_stands_upright_on_the_plinth(tmp_path):
    path = tmp_path / "half.ply"
    path.write_text(PLY)
    vertices, sizes, corners = mesh_file.load(path, 0.3, 0.2)
    assert sizes.tolist() == [4, 3, 3] and len(vertices) == 6 and corners.max() == 5
    # 2 x 3 x 2 with y up: the height limits the scale.
    assert vertices.min(axis=0) == pytest.approx((-1 / 15, -1 / 15, 0.0), abs=1e-6)
    assert vertices.max(axis=0) == pytest.approx((1 / 15, 1 / 15, 0.2), abs=1e-6)
    assert np.ptp(mesh_file.load(path, 0.1, 0.2, up="z")[0], axis=0)[1] == pytest.approx(0.1)
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
    vertices, sizes, _ = mesh_file.load(path, 0.3, 0.2, up="z")
    assert len(vertices) == 4 and sizes.tolist() == [3, 3, 3]
    assert (set(bpy.data.objects), len(bpy.data.curves), len(bpy.data.meshes)) == before


def test_a_packed_file_is_what_it_packs(tmp_path):
    plain, packed = tmp_path / "half.ply", tmp_path / "half.ply.gz"
    plain.write_text(PLY)
    packed.write_bytes(gzip.compress(PLY.encode(), mtime=0))
    for one, other in zip(mesh_file.load(plain, 0.3, 0.2), mesh_file.load(packed, 0.3, 0.2), strict=True):
        assert np.array_equal(one, other)
    damaged = bytearray(packed.read_bytes())
    damaged[40] ^= 255
    packed.write_bytes(damaged)
    with pytest.raises(ValueError, match="half.ply.gz: is a damaged gzip file") as caught:
        mesh_file.load(packed, 0.3, 0.2)
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
        mesh_file.load(path, 0.3, 0.2)


@with_embree
def test_the_scene_renders_cleaner_and_dustier(tmp_path, addon, monkeypatch, rough_dragon):
    monkeypatch.setattr(extension, "PACKAGE", addon.__name__)
    monkeypatch.setattr(sculpture, "build", lambda *grid: rough_dragon)
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

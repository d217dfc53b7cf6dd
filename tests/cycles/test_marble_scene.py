# SPDX-License-Identifier: GPL-3.0-or-later
"""The marble scene's plain functions: differences without noise, columns, bodies, pixels, averages on a mesh.

The demo runs at the tiny quality.

Seeds are fixed.
"""

import dataclasses
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from PIL import Image
from z_limit import z_limit

import lamina
from lamina.maps import places

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "demo_scenes"))

import extension  # noqa: E402
from marble import bodies, columns, demo, differences, light, methods, portrait, sheet, turn, veins, view  # noqa: E402

EVERYWHERE = np.ones((24, 24), bool)
SUN_BELOW = np.array((0.3, -0.4, -0.866))


def noisy(mean, seeds, sigma, seed):
    """Pictures (seeds, 24, 24, 3) around `mean` (24, 24, 3)."""
    return mean + sigma * np.random.default_rng(seed).standard_normal((seeds, *mean.shape))


@pytest.fixture(scope="module")
def bumpy():
    """A picture of mean 1 with an rms of .1 around it."""
    values = np.random.default_rng(5).standard_normal((24, 24, 3))
    return 1.0 + 0.1 * (values - values.mean()) / values.std()


@pytest.mark.parametrize(("apart", "sets"), [(0.0, 3), (0.0, 6), (0.04, 3), (0.04, 6)])
def test_differences_without_noise(bumpy, apart, sets):
    """The noise is several times the difference; the estimate stays within its own standard error."""
    scores = []
    for seed in range(12):
        truth = noisy(bumpy, 8, 0.3, 100 + seed)
        pattern = np.sign(np.random.default_rng(7).standard_normal(bumpy.shape))
        other = noisy(bumpy + apart * pattern + 0.01, sets, 0.2, 200 + seed)
        found = differences.difference(truth, other, EVERYWHERE)
        shift = (apart * pattern + 0.01) / truth.mean()
        expected = np.mean(shift**2)
        scores += [(found.square - expected) / found.square_error, (found.mean - shift.mean()) / found.mean_error]
        assert found.rms_with_noise > 2.0 * np.sqrt(expected)
    # With few seeds the jackknife's own error is that of a t distribution with as many degrees of freedom.
    assert np.abs(scores).max() < z_limit(len(scores), 1e-3, sets - 1)


def test_a_picture_without_noise_is_compared_too(bumpy):
    truth = noisy(bumpy, 8, 0.3, 1)
    found = differences.difference(truth, 1.05 * bumpy[None], EVERYWHERE)
    assert abs(found.mean - 0.05) < 4.0 * found.mean_error
    assert abs(found.square - 0.05**2 * 1.01) < 4.0 * found.square_error
    assert differences.noise(truth, EVERYWHERE) == pytest.approx(0.3 / np.sqrt(8), rel=0.05)


def test_only_the_region_counts(bumpy):
    truth, region = noisy(bumpy, 4, 0.0, 1), EVERYWHERE.copy()
    region[:, :12] = False
    other = truth.copy()
    other[:, :, :12] = np.nan
    assert differences.difference(truth, other, region).square == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("sun", [np.array(light.TOWARDS_SUN), SUN_BELOW], ids=["above", "below"])
def test_columns_of_a_uniform_slab_are_walks_in_a_wide_slab(monkeypatch, sun):
    """The 1D answer against walks in 3D, where both must be the same; with the sun above and below the slab."""
    monkeypatch.setattr(light, "TOWARDS_SUN", tuple(sun))
    share, thickness, half = 0.3, 1.3, 60.0
    ends = [lamina.EndMaterial(*end) for end in (veins.WHITE, veins.VEIN)]
    interior = lamina.Interior.mixed(np.full((1, 1, 1), share), ends, (-half, -half, -thickness), (half, half, 0.0))
    monkeypatch.setattr(bodies, "SLAB_WIDTH", 2.0 * half)
    monkeypatch.setattr(bodies, "SLAB_THICKNESS", thickness)
    slab = bodies.slab(half)
    eye = np.array((0.6, 0.0, 0.8))
    points, normals = np.array([[0.3, -0.2, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    exact, solved = columns.radiance(interior, np.array([thickness]), points, normals, eye, np.array([True]))
    walked = lamina.light_in_mesh(lamina.Solid(slab.vertices, slab.triangles()), interior, [lamina.Lamp(tuple(sun))],
                                  points, normals, directions=eye, samples=60000, seed=3)
    radiance = light.radiance(walked.lamps.value[:, 0], walked.sky.value)
    # Sun and sky share walks: their errors add up at most.
    stderr = light.radiance(walked.lamps.stderr[:, 0], walked.sky.stderr)
    assert solved == 1 and (stderr < 0.01 * radiance).all()
    # The thickness is rounded by 1 % at most, which moves the answer by less.
    assert (np.abs(radiance - exact) < z_limit(3) * stderr + 0.005 * exact).all()


def test_sublayers_and_rounding_barely_matter(monkeypatch):
    """Columns through veins, against the same with sublayers and levels several times finer."""
    layers = np.clip(np.sin(np.linspace(0.0, 40.0, 240)), 0.0, 1.0)[None, None, :]
    ends = [lamina.EndMaterial(*end) for end in (veins.WHITE, veins.VEIN)]
    interior = lamina.Interior.mixed(np.tile(layers, (2, 2, 1)), ends, (0.0, 0.0, -12.0), (1.0, 1.0, 0.0))
    heights = np.array([0.0, -1.0, -2.0, -3.5])
    points = np.column_stack([np.full((4, 2), 0.5), heights])
    normals = np.tile((0.0, 0.0, 1.0), (4, 1))
    given = (interior, 12.0 + heights, points, normals, (0.0, 0.0, 1.0), np.ones(4, bool))
    usual, solved = columns.radiance(*given)
    for name, value in (("FIRST", 0.05), ("GROWTH", 1.1), ("LEVELS", 256), ("THICKNESS_STEP", 0.001)):
        monkeypatch.setattr(columns, name, value)
    fine, _ = columns.radiance(*given)
    assert solved == 4 and usual == pytest.approx(fine, rel=0.012)


@pytest.mark.parametrize("build", [bodies.slab, bodies.cup])
def test_bodies_are_closed_and_oriented(build):
    body = build()
    edges = np.stack([body.faces, np.roll(body.faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    directed = set(map(tuple, edges))
    assert len(directed) == len(edges)  # each edge once in each direction
    assert all((b, a) in directed for a, b in directed)
    corners = body.vertices[body.triangles()]
    volume = np.einsum("tk,tk->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0
    if build is bodies.slab:
        assert volume == pytest.approx(bodies.SLAB_WIDTH**2 * bodies.SLAB_THICKNESS)
    else:
        assert 300.0 < volume < 900.0  # mm^3, of thin walls: the full ball would have 2100


def test_pixels_of_the_slab_are_where_the_camera_sees_them():
    body, size = bodies.slab(4.0), 8
    seen = view.seen(body, body.tree(), size, [(0.5, 0.5)])
    middles = (np.arange(size) + 0.5) / size * body.width - 0.5 * body.width
    expected = [(x, -y, 0.0) for y in middles for x in middles]
    assert seen.hit.all() and view.region(body, body.tree(), size).all()
    np.testing.assert_allclose(seen.points, expected, atol=1e-4)
    np.testing.assert_allclose(seen.normals, np.tile((0.0, 0.0, 1.0), (size * size, 1)), atol=1e-6)
    down = np.tile((0.0, 0.0, -1.0), (size * size, 1))
    assert view.lengths(body.tree(), seen.points, down) == pytest.approx(bodies.SLAB_THICKNESS, rel=1e-4)
    assert np.isinf(view.lengths(body.tree(), seen.points, -down)).all()


@pytest.mark.parametrize("size", [90, 180])
def test_the_extension_unwraps_the_cup_without_overlaps(addon, size):
    """With a limit of 66 degrees, islands of the handle folded over: .4 % of the texels lay on two parts."""
    body = bodies.cup()
    mesh = body.mesh()
    thing = bpy.data.objects.new("cup", mesh)
    layer = mesh.uv_layers[addon.base.unwrap.ensure(thing)]
    corners = np.empty(2 * len(mesh.loops), np.float32)
    layer.uv.foreach_get("vector", corners)
    mesh.calc_loop_triangles()
    triangles, loops = (np.array([getattr(one, name) for one in mesh.loop_triangles]) for name in ("vertices", "loops"))
    found = places.places_of(lamina.Solid(body.vertices, triangles), corners.reshape(-1, 2)[loops], size, None)
    assert 0.35 < found.mask.mean() < 0.6  # bodies.UNWRAPPED
    bpy.data.objects.remove(thing)


def test_the_verdict_follows_the_numbers():
    def numbers(rms, error=1e-4):
        return {"square": rms**2, "square_error": error}

    good = {"lit": numbers(0.01), "relightable": numbers(0.05), "stock": numbers(0.2)}
    assert demo.verdict_holds(good)
    assert not demo.verdict_holds({**good, "lit": numbers(0.04)})
    assert not demo.verdict_holds({**good, "relightable": numbers(0.12)})
    assert not demo.verdict_holds({**good, "lit": numbers(float("nan"))})


def test_the_sheet_is_written(tmp_path):
    pictures = {name: np.full((6, 6, 3), 0.5 + 0.1 * k) for k, name in enumerate(methods.NAMES.values())}
    lines = [["a", "b"]] * len(pictures)
    sheet.save(tmp_path / "marble.png", ("Title", "more"), [(pictures, np.ones((6, 6), bool), lines)] * 2, 1.0)
    assert (tmp_path / "marble.png").stat().st_size > 1000 and len(list(tmp_path.iterdir())) == 1


def test_a_sun_goes_around(addon, monkeypatch):
    """First on the camera's right, then on its left."""
    monkeypatch.setattr(extension, "PACKAGE", addon.__name__)
    lamp = (portrait.CANDLE.eye[0] + 90.0, 10.0, 3.0, (3.0, 3.0, 3.0))
    stone = dataclasses.replace(portrait.CANDLE, lamps=(lamp,), flame=())
    right, left = turn.frames(stone, portrait.cup(), portrait.Effort(2, 48, 4), 2)
    half = right.shape[1] // 2
    assert np.isfinite([right, left]).all()
    assert right[:, half:].mean() > 1.2 * right[:, :half].mean()
    assert left[:, :half].mean() > 1.2 * left[:, half:].mean()


def test_the_demo_makes_its_files(demo, tmp_path):
    facts, _ = demo("marble")
    *dragons, cup = (found["walked"] for found in facts["portraits"].values())
    assert all(walked > 50_000 for walked in dragons) and len(dragons) == 2 and cup > 5_000
    for name in ("marble", "marble_lit"):
        with Image.open(tmp_path / f"{name}.png") as picture:
            assert picture.width >= 3 * facts["effort_portraits"][0]["size"]

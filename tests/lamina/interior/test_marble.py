# SPDX-License-Identifier: GPL-3.0-or-later
"""Marble: noise, veins and files."""

import itertools
import json
import math

import numpy as np
import pytest

import lamina
from lamina import InteriorError, Marble
from lamina.interior.noise import gradient_noise, turbulence


def test_noise_is_0_on_the_lattice_and_smooth_between():
    lattice = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 3), axis=-1).astype(float)
    assert np.abs(gradient_noise(lattice, 5)).max() == 0.0
    places = np.random.default_rng(1).uniform(-40.0, 40.0, (200000, 3))
    values = gradient_noise(places, 5)
    assert abs(values.mean()) < 0.01 and 0.2 < values.std() < 0.35 and np.abs(values).max() < 1.1
    near = gradient_noise(places + 1e-3, 5)
    assert np.abs(near - values).max() < 0.01
    assert abs(np.corrcoef(values, gradient_noise(places, 6))[0, 1]) < 0.02
    # The slope is also continuous across a face of the lattice.
    face = np.column_stack([np.full(1000, 2.0), places[:1000, 1:]])
    left, middle, right = (gradient_noise(face + [shift, 0, 0], 5) for shift in (-1e-2, 0.0, 1e-2))
    assert np.abs(left - 2.0 * middle + right).max() < 1e-3


def noise_at(place, seed):
    """Reference implementation of the noise in Python numbers, for one position."""
    mask = (1 << 64) - 1
    edges = [(x, y, 0) for x in (-1, 1) for y in (-1, 1)] + [(x, 0, z) for x in (-1, 1) for z in (-1, 1)] + \
        [(0, y, z) for y in (-1, 1) for z in (-1, 1)]
    cell = [math.floor(u) for u in place]
    total = 0.0
    for corner in itertools.product((0, 1), repeat=3):
        key = seed
        for base, end, multiplier in zip(cell, corner, (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9),
                                         strict=True):
            key ^= (base + end) * multiplier & mask
        key = (key ^ key >> 30) * 0xBF58476D1CE4E5B9 & mask
        key = (key ^ key >> 27) * 0x94D049BB133111EB & mask
        key ^= key >> 31
        value, weight = 0.0, 1.0
        for u, base, end, slope in zip(place, cell, corner, edges[(key >> 40) % 12], strict=True):
            t = u - base
            fade = t * t * t * (t * (6.0 * t - 15.0) + 10.0)
            value += slope * (t - end)
            weight *= fade if end else 1.0 - fade
        total += weight * value
    return total


def test_the_noise_is_the_same_on_every_machine():
    """Compared with Python's unbounded integers, also at negative positions."""
    places = np.random.default_rng(3).uniform(-100.0, 100.0, (50, 3))
    expected = [noise_at(place, 7) for place in places.tolist()]
    assert np.abs(expected).max() > 0.3
    assert gradient_noise(places, 7) == pytest.approx(expected, abs=1e-5)


def test_turbulence_of_one_octave_is_the_absolute_noise():
    places = np.random.default_rng(2).uniform(-9.0, 9.0, (1000, 3))
    assert turbulence(places, 1, 2.0, 0.5, 3) == pytest.approx(np.abs(gradient_noise(places, 3 * 64)), abs=1e-6)


def test_veins_without_distortion_are_planes():
    veins = Marble(spacing=4.0, direction=(0, 0, 2), width=0.5, distortion=0.0)
    z = np.array([0.0, 0.5, 1.0, 2.0, 4.0, -4.0])
    expected = np.exp(-np.array([0.0, 0.25, 1.0, 4.0, 0.0, 0.0]))
    assert veins.coordinate(np.column_stack([z, z, z])) == pytest.approx(expected, abs=1e-12)


def test_a_grid_holds_the_veins_at_the_centres_of_voxels():
    veins = Marble(seed=4, spacing=5.0)
    interior = lamina.marble((0, 0, 0), (10, 5, 7.6), 20, veins)
    assert interior.voxels.shape == (20, 10, 16)
    centre = np.array([[3.5, 4.5, 9.5]]) / [20, 10, 16] * [10, 5, 7.6]
    assert interior.voxels[3, 4, 9] == pytest.approx(65535 * veins.coordinate(centre)[0], abs=0.51)
    assert interior.hash == lamina.marble((0, 0, 0), (10, 5, 7.6), 20, veins).hash
    assert interior.hash != lamina.marble((0, 0, 0), (10, 5, 7.6), 20, Marble(seed=5, spacing=5.0)).hash
    assert len(np.unique(interior.voxels)) > 100


def test_files(tmp_path):
    veins = Marble(palette=[lamina.EndMaterial(k, 0.1 * k, 0.2) for k in (1, 2, 3)], seed=9, octaves=3)
    path = tmp_path / "veins.json"
    veins.save(path)
    assert Marble.load(path) == veins
    assert Marble.from_json({"format": "lamina-marble", "schema": 1}) == Marble()


@pytest.mark.parametrize(("change", "words"), [
    ({"width": 0.0}, r"width = 0.0: must lie in \[0.001, 1\]"),
    ({"spacing": -1}, "spacing = -1: must lie in"),
    ({"octaves": 2.5}, "octaves = 2.5: must be a whole number from 1 to 12"),
    ({"direction": [0, 0, 0]}, "direction = .*not all 0"),
    ({"seed": -3}, "seed = -3"),
    ({"palette": []}, "palette = "),
    ({"palette": [{"sigma_s": 1.0, "sigma_a": -1.0, "g": 0.0}] * 2}, r"palette\[0\].sigma_a = -1: must lie in"),
    ({"palette": [{"sigma_s": 1.0}]}, r"palette\[0\] = .*must be an object of sigma_s, sigma_a and g"),
    ({"colour": 1}, "'colour': must be one of palette, spacing"),
    ({"schema": 2}, "schema = 2: must be 1"),
    ({"format": "lamina-stack"}, "not a marble of Lamina"),
])
def test_bad_files(change, words, tmp_path):
    path = tmp_path / "veins.json"
    path.write_text(json.dumps(Marble().to_json() | change))
    with pytest.raises(InteriorError, match=f"veins.json: .*{words}"):
        Marble.load(path)


def test_bad_arguments():
    with pytest.raises(InteriorError, match="must be above low"):
        lamina.marble((0, 0, 0), (1, -1, 1))
    with pytest.raises(lamina.ArgumentError, match="voxels = 5000: must be a whole number from 1 to 1024"):
        lamina.marble((0, 0, 0), (1, 1, 1), 5000)
    with pytest.raises(lamina.Cancelled):
        lamina.marble((0, 0, 0), (1, 1, 1), 8, cancel=lambda: True)

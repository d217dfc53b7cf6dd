# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input gives one sentence that names field, value and range."""

import numpy as np
import pytest
from map_meshes import slab_with_uvs

import lamina
from lamina import ArgumentError, EndMaterial, Interior, InteriorError, Lamp, Surface

SOLID, UVS = slab_with_uvs(1.0)
GREY = Interior.uniform(EndMaterial(1.0, 0.5))
OVER = np.where(np.isin(np.arange(12), (0, 1, 2, 3))[:, None, None], UVS[(UVS != 0).any(axis=(1, 2))][0], UVS)
OPEN = lamina.Solid(SOLID.vertices, SOLID.triangles[1:])
FLIPPED = lamina.Solid(SOLID.vertices, SOLID.triangles[:, ::-1])
EMPTY = lamina.Solid(np.zeros((0, 3)), np.zeros((0, 3), int))


@pytest.mark.parametrize(("change", "error", "words"), [
    ({"noise": 0.0}, ArgumentError, r"noise = 0.0: must lie in \(0, 1\]"),
    ({"noise": float("nan")}, ArgumentError, "noise = nan"),
    ({"samples": 0}, ArgumentError, "samples = 0: must be a whole number from 1 to"),
    ({"margin": 65}, ArgumentError, "margin = 65: must be a whole number from 0 to 64"),
    ({"size": None}, ArgumentError, "size and uvs must be given together"),
    ({"size": 0}, InteriorError, "size = 0: must be one or two whole numbers from 1 to 16384"),
    ({"uvs": UVS[1:]}, InteriorError, r"uvs_per_corner has shape \(11, 3, 2\): must be \(12, 3, 2\)"),
    ({"uvs": 10**400}, InteriorError, "uvs_per_corner = 1000.*: must be an array of numbers"),
    ({"uvs": UVS * np.nan}, InteriorError, r"uvs_per_corner\[0\]: must be finite"),
    ({"uvs": 0.0 * UVS}, InteriorError, "the UV map has no area"),
    ({"uvs": OVER}, InteriorError, "texels lie on two parts of the surface, because islands of the UV map overlap"),
    ({"solid": OPEN, "uvs": UVS[1:]}, InteriorError, "is open along 3 edges"),
    ({"solid": FLIPPED, "uvs": UVS[:, ::-1]}, InteriorError, "is inside out"),
    ({"solid": EMPTY, "uvs": None, "size": None}, InteriorError, "has no vertices with a normal"),
    ({"solid": 3}, InteriorError, "solid = int: must be a lamina.Solid"),
    ({"interior": EndMaterial(1.0)}, ArgumentError, "interior = .*: must be a lamina.Interior"),
    ({"surface": 1.4}, ArgumentError, "surface = 1.4: must be a lamina.Surface"),
    ({"seed": -1}, ArgumentError, "seed = -1"),
    ({"folder": 3}, ArgumentError, "folder = 3: must be a path or None"),
    ({"progress": 3}, ArgumentError, "progress = 3: must be a function or None"),
])
def test_bad_arguments(change, error, words):
    how = {"solid": SOLID, "interior": GREY, "uvs": UVS, "size": 4, "samples": 2, **change}
    for call in (lamina.relightable_images, lamina.lit_images):
        with pytest.raises(error, match=words):
            call(**how)


@pytest.mark.parametrize(("change", "words"), [
    ({"view": [0, 0, 1], "eye": [0, 0, 1]}, "view and eye are both given"),
    ({"view": [0, 0, 0]}, r"view = \[0, 0, 0\]: must be three numbers, not all 0"),
    ({"eye": [0, 0]}, r"eye = \[0, 0\]: must be three lengths in mm"),
    ({"eye": [0, 0, np.inf]}, "eye holds a value that is not finite"),
    ({"lamps": Lamp([0, 0, 1])}, "lamps = .*: must be a list of lamina.Lamp"),
    ({"lamps": None}, "lamps = None: must be a list of lamina.Lamp"),
    ({"lamps": [Lamp([0, 0, 1])], "surface": Surface(1.5)}, r"lamps\[0\].angle = 0: must be at least"),
])
def test_bad_lights(change, words):
    with pytest.raises(ArgumentError, match=words):
        lamina.lit_images(SOLID, GREY, **{"samples": 2, **change})


def test_bad_releases():
    with pytest.raises(ArgumentError, match="version = .4, 1.: must be a release of Blender from .4, 2. on"):
        lamina.relightable_images(SOLID, GREY, samples=2, version=(4, 1))
    with pytest.raises(ArgumentError, match="mu = 'mean': must lie in .0, 1., or be .diffuse."):
        lamina.subsurface_inputs(0.5, 1.0, mu="mean")

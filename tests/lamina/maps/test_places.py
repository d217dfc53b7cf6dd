# SPDX-License-Identifier: GPL-3.0-or-later
"""Which parts of the surface have texels, and the notes on the others."""

import numpy as np
import pytest
from walk_meshes import box

from lamina import InteriorError
from lamina.maps.places import places_of

CUBE = box((0, 0, 0), (1, 1, 1))
FACES = np.arange(12) // 2  # two triangles each


def uvs(elsewhere):
    """The first three faces side by side in the image, the others at one point."""
    found = np.full((12, 3, 2), elsewhere, float)
    corners = CUBE.vertices[CUBE.triangles]
    for face in range(3):
        across = [axis for axis in range(3) if np.ptp(corners[2 * face:2 * face + 2, :, axis]) > 0.0]
        for triangle in (2 * face, 2 * face + 1):
            found[triangle] = corners[triangle][:, across] / (3.0, 1.0) + (face / 3.0, 0.0)
    return found


@pytest.mark.parametrize("normals", [None, np.ones((8, 3)), np.ones((12, 3, 3))], ids=["none", "vertices", "corners"])
def test_faces_that_are_left_out_on_purpose_need_no_note(normals):
    """Their texels are the same as those of faces that were forgotten."""
    forgotten, left_out = (places_of(CUBE, uvs(where), (12, 4), normals) for where in (0.0, -1.0))
    assert forgotten.notes == ("50 % of the surface has no area in the UV map, and so no texels",)
    assert left_out.notes == () and left_out.mask.all()
    np.testing.assert_array_equal(left_out.points.positions, forgotten.points.positions)
    np.testing.assert_array_equal(left_out.points.normals, forgotten.points.normals)


def test_notes_count_the_other_faces():
    """Of three faces that are wanted, one has no area, or lies beyond the image."""
    map_ = uvs(-1.0)
    map_[FACES == 1] = 0.25
    assert places_of(CUBE, map_, (12, 4), None).notes == (
        "33 % of the surface has no area in the UV map, and so no texels",)
    map_ = uvs(-1.0)
    map_[FACES == 2] += (1.0, 0.0)
    (note,) = places_of(CUBE, map_, (12, 4), None).notes
    assert note.startswith("33 % of the surface is unwrapped beyond the image (u from 0 to 2, v from 0 to 1)")


def test_overlaps_and_nothing_at_all():
    map_ = uvs(-1.0)
    map_[FACES == 1] -= (1.0 / 3.0, 0.0)
    words = "144 of 288 texels lie on two parts of the surface, .* [(]in Blender: after modifiers that copy faces are"
    with pytest.raises(InteriorError, match=words):
        places_of(CUBE, map_, (36, 12), None)
    with pytest.raises(InteriorError, match="the UV map has no area"):
        places_of(CUBE, np.full((12, 3, 2), -1.0), (12, 4), None)

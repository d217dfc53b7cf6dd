# SPDX-License-Identifier: GPL-3.0-or-later
"""Images while the walks are running: all points at once, first coarse, later with less noise."""

import numpy as np
import pytest
from map_meshes import slab_with_uvs
from z_limit import z_limit

import lamina
from lamina import EndMaterial, Interior, Lamp

SOLID, UVS = slab_with_uvs(2.0)
GREY = Interior.uniform(EndMaterial(1.0, 0.5))
SUN = [Lamp((0.3, 0.2, 1.0))]
HOW = {"uvs": UVS, "size": 24, "seed": 3}


def lit(**more):
    return lamina.lit_images(SOLID, GREY, SUN, **{**HOW, **more})


def test_previews_double_the_samples_and_approach_the_result():
    shown = []
    found = lit(samples=64, preview=shown.append)
    assert [one.done for one in shown] == [1 / 16, 1 / 8, 1 / 4, 1 / 2]
    assert [one.estimate.count.samples for one in shown] == [4, 8, 16, 32]
    assert found.done == 1.0 and found.estimate.count.samples == 64
    noises = [one.noise for one in [*shown, found]]
    assert np.allclose(np.array(noises[:-1]) / noises[1:], np.sqrt(2.0), rtol=0.15)
    assert all(one.lamps.shape == found.lamps.shape and (one.mask == found.mask).all() for one in shown)
    assert "preview from 6 % of the samples" in shown[0].report and "preview" not in found.report


def test_the_first_preview_comes_from_the_trial():
    """Interpolated between few points, without bias: compared with the values that the final image has."""
    shown = []
    found = lit(size=40, noise=0.05, preview=shown.append)
    first = shown[0]
    assert first.done == 0.0 and "trial" in first.report and (first.mask == found.mask).all()
    assert (first.lamps[0][first.mask] > 0.0).all()
    # The interpolated values of a homogeneous slab are those of 512 points with 24 samples each.
    error = first.estimate.lamps.stderr.mean() / np.sqrt(512.0)
    apart = first.lamps.mean() - found.lamps.mean()
    assert abs(apart) < z_limit(1) * np.hypot(error, found.estimate.lamps.stderr.mean() / 40.0)


def test_previews_do_not_change_the_result():
    """The samples are the same; only the sequence in which they are added differs."""
    with_previews, without = lit(samples=40, preview=lambda _: None), lit(samples=40)
    np.testing.assert_allclose(with_previews.lamps, without.lamps, rtol=1e-5)
    np.testing.assert_allclose(with_previews.estimate.lamps.stderr, without.estimate.lamps.stderr, rtol=1e-6)


def test_a_cancelled_run_continues_with_the_same_bytes(tmp_path):
    shown = []
    whole = lit(samples=40, threads=1, preview=lambda _: None)
    with pytest.raises(lamina.Cancelled):
        lit(samples=40, folder=tmp_path, preview=shown.append, cancel=lambda: len(shown) == 2)
    again = []
    found = lit(samples=40, folder=tmp_path, preview=again.append)
    assert found.lamps.tobytes() == whole.lamps.tobytes()
    assert again[1].lamps.tobytes() == shown[1].lamps.tobytes()


def test_relightable_previews():
    shown = []
    found = lamina.relightable_images(SOLID, GREY, **HOW, samples=16, preview=shown.append)
    assert [one.done for one in shown] == [0.25, 0.5] and found.done == 1.0
    assert all(one.inputs.color.shape == found.inputs.color.shape for one in shown)
    assert shown[0].report.startswith("Colors and radii, preview from 25 % of the samples")


def test_a_preview_that_cannot_be_called_is_refused():
    with pytest.raises(lamina.ArgumentError, match="preview"):
        lit(samples=4, preview=3)

# SPDX-License-Identifier: GPL-3.0-or-later
"""A sphere under a sun: the exact function in Mitsuba 3 against the baked material in Cycles, within the error of the
fit."""

import math

import baked_samples
import lit_sphere
import mitsuba as mi
import numpy as np
import pytest

import lamina
import lamina.mitsuba
from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack

STACKS = {
    "rough coat": Stack([Interface(1.5, 0.2), Medium(0.8, 1.0, HenyeyGreenstein(0.6))], Lambert(0.5)),
    "dusty metal": Stack([Medium(0.9, 0.3, HenyeyGreenstein(0.5))], Conductor(0.2, 3.9, alpha=0.3)),
}


SUN = np.array([math.cos(math.radians(25.0)), math.sin(math.radians(25.0)), 1.0]) / math.sqrt(2.0)


def by_function(brdf):
    """The picture of a function of (mu_o, mu_i, dphi), one point in each pixel, shape (64, 64)."""
    x, y = np.meshgrid((np.arange(64) - 31.5) * 2.2 / 64, (np.arange(64) - 31.5) * 2.2 / 64)
    z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    mu_i = np.maximum(np.stack([x, y, z], axis=-1) @ SUN, 0.0)
    # cos(dphi) from the angle between view and light; light keeps its azimuth at dphi = 0.
    sines = np.sqrt(np.maximum((1.0 - z * z) * (1.0 - mu_i * mu_i), 1e-12))
    dphi = np.arccos(np.clip((z * mu_i - SUN[2]) / sines, -1.0, 1.0))
    seen = (z > 0.05) & (mu_i > 0.0)
    picture = np.zeros((64, 64))
    picture[seen] = math.pi * mu_i[seen] * brdf(z[seen], mu_i[seen], dphi[seen])[:, 0]
    return picture


def in_mitsuba(table):
    """The red channel of the scene of lit_sphere, shape (64, 64), from the bottom row to the top."""
    mi.set_variant("scalar_rgb")
    place = mi.ScalarTransform4f().look_at([0, 0, 10], [0, 0, 0], [0, 1, 0]) @ mi.ScalarTransform4f().scale(1.1)
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "direct"},
        "ball": {"type": "sphere", "bsdf": lamina.mitsuba.bsdf(table)},
        "sun": {"type": "directional", "direction": (-SUN).tolist(),
                "irradiance": {"type": "rgb", "value": math.pi}},
        "sensor": {"type": "orthographic", "to_world": place, "sampler": {"type": "stratified"},
                   "film": {"type": "hdrfilm", "width": 64, "height": 64, "rfilter": {"type": "box"}}}})
    return np.array(mi.render(scene, spp=4, seed=1))[::-1, :, 0]


def smooth(scene):
    """Normals of a sphere in place of those of its flat faces."""
    for thing in scene.objects:
        if thing.type == "MESH":
            thing.data.shade_smooth()


@pytest.mark.parametrize("name", STACKS)
def test_the_same_picture(addon, name):
    stack = STACKS[name]
    sample = baked_samples.make_sample(addon, name, stack, None, "preview", basis="standard")
    cycles = lit_sphere.pixels(sample.material, 16, 1, smooth)
    solved = lamina.solve(stack)
    exact = in_mitsuba(lamina.mitsuba.RenderTable.of(solved, "preview"))
    fitted, true = by_function(sample.lut.evaluate), by_function(solved.brdf)
    cycles, exact, fitted, true = map(lit_sphere.blocks_of, (cycles, exact, fitted, true))
    inside = np.hypot(*np.meshgrid(np.arange(16) - 7.5, np.arange(16) - 7.5)) < 0.9 * 16 / 2.2 - 0.7

    def error(one, other):
        return np.linalg.norm((one - other)[inside]) / np.linalg.norm(exact[inside])

    assert error(exact, true) < 2e-3, "means of 4 x 4 pixels keep an error of .2 %"
    assert error(cycles, exact) < error(fitted, true) + 2e-3

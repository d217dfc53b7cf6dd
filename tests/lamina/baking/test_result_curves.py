# SPDX-License-Identifier: GPL-3.0-or-later
"""The curves of a result, and the pictures that are drawn from them."""

import json
from dataclasses import replace

import numpy as np
import pytest

import lamina
from lamina.baking.report import result_picture
from lamina.baking.report.result_curves import result_curves

GREY = (0.5, 0.5, 0.5)
DUST = lamina.Medium(albedo=[0.9, 0.8, 0.6], tau=0.5)
GREY_DUST = lamina.Medium(albedo=0.8, tau=0.5)
COLOR = [0.5, 0.3, 0.1]
NODES = 16
MU_O = np.cos(np.radians([0.0, 40.0, 70.0]))
# A stack for each way in which a table shows a base, and the largest error of a fitted lobe in the plane of incidence
# (L2, relative); the fit's own errors over solid angle are tested with the table's evaluation.
STACKS = {
    "boundary": (lamina.Stack([lamina.Interface(ior=1.5, alpha=0.3), DUST], base=lamina.Lambert(COLOR)), 0.03),
    "smooth": (lamina.Stack([lamina.Interface(ior=1.5, alpha=0.02), DUST], base=lamina.Lambert(COLOR)), 0.03),
    "varying": (lamina.Stack([replace(DUST, varying=True)], base=lamina.Lambert(COLOR)), 0.06),
    "textured": (lamina.Stack([DUST], base=lamina.Lambert(COLOR, textured=True)), 0.06),
    "shader": (lamina.Stack([DUST], base=lamina.ShaderBase(COLOR)), 0.15),
    "principled": (lamina.Stack([GREY_DUST], base=lamina.PrincipledBase(
        color=0.4, roughness=0.5, metallic=0.5, inputs=["color", "metallic"])), 0.2),
}  # fmt: skip


@pytest.fixture(scope="module")
def matte():
    """A Lambert surface below nothing."""
    stack = lamina.Stack([lamina.Medium(albedo=0.5, tau=0.0)], base=lamina.Lambert([0.8, 0.4, 0.2]))
    return result_curves(stack, lamina.bake(stack, "preview"))


@pytest.fixture(scope="module")
def sheet():
    """A sheet that scatters nothing and absorbs half of the light at normal incidence."""
    stack = lamina.Stack([lamina.Medium(albedo=0.0, tau=float(np.log(2.0)))])
    return result_curves(stack, lamina.bake(stack, "preview"))


def test_a_lambert_surface_has_cosine_lobes_and_a_constant_albedo(matte):
    luminance = 0.2126 * 0.8 + 0.7152 * 0.4 + 0.0722 * 0.2
    cosine = luminance * np.cos(np.radians(matte["lights"])) / np.pi
    for name in ("exact", "fitted"):
        assert np.array(matte[name]) == pytest.approx(np.broadcast_to(cosine, (3, len(cosine))), rel=2e-3)
    assert np.array(matte["reflectance"]) == pytest.approx(np.full((22, 3), [0.8, 0.4, 0.2]), rel=2e-3)
    assert matte["views"] == [0.0, 40.0, 70.0] and matte["mirrored"] == [0.0] * 3
    assert matte["through_exact"] is None and matte["transmittance"] is None


def test_a_clear_sheet_passes_light_straight(sheet):
    views = np.array(sheet["views"])
    assert sheet["straight"] == pytest.approx(0.5 ** (1.0 / np.cos(np.radians(views))), rel=1e-3)
    assert np.abs(sheet["through_exact"]).max() < 1e-6 and np.abs(sheet["reflectance"]).max() < 1e-6


@pytest.mark.parametrize("name", STACKS)
def test_fitted_lobes_lie_on_the_exact_ones_for_each_kind_of_base(name):
    stack, largest = STACKS[name]
    curves = result_curves(stack, lamina.bake(stack, "preview", nodes=NODES))
    exact, fitted = np.array(curves["exact"]), np.array(curves["fitted"])
    error = np.linalg.norm(fitted - exact, axis=1) / np.linalg.norm(exact, axis=1)
    assert error.max() < largest and error.max() > 0.0
    assert (np.array(curves["mirrored"]) > 0.0).all() == (name == "smooth")


def test_curves_are_the_mixture_and_the_function_in_the_plane_of_incidence():
    stack, _ = STACKS["boundary"]
    curves = result_curves(stack, lamina.bake(stack, "preview", nodes=NODES))
    exact, fitted = np.array(curves["exact"]), np.array(curves["fitted"])
    assert (np.linalg.norm(fitted - exact, axis=1) / np.linalg.norm(exact, axis=1)).max() < 0.03
    assert json.loads(json.dumps(curves)) == curves
    luminance = lamina.solve(stack).brdf(MU_O[2], np.cos(np.radians(50.5)), np.pi) @ [0.2126, 0.7152, 0.0722]
    place = curves["lights"].index(-50.5)
    assert exact[2, place] == pytest.approx(luminance * np.cos(np.radians(50.5)), rel=0.01)


def test_a_mirror_lobe_is_on_the_side_away_from_the_viewer():
    stack = lamina.Stack([lamina.Interface(ior=1.5, alpha=0.1)], base=lamina.Lambert(0.0))
    curves = result_curves(stack, lamina.bake(stack, "preview", nodes=NODES))
    lights, exact = np.array(curves["lights"]), np.array(curves["exact"])
    assert lights[exact[1].argmax()] == pytest.approx(40.0, abs=3.0)
    thin = lamina.Stack([lamina.Medium(albedo=1.0, tau=0.2, phase=lamina.HenyeyGreenstein(0.8))])
    curves = result_curves(thin, lamina.bake(thin, "preview", nodes=NODES))
    assert lights[np.array(curves["through_exact"])[1].argmax()] == pytest.approx(40.0, abs=3.0)


def test_pixels_of_a_lobe(matte):
    size = 200
    pixels = result_picture.lobe_picture(matte, 1, size, ink=(1.0, 1.0, 1.0))
    assert pixels.shape == (size, size, 4) and pixels.dtype == np.float32
    assert pixels.min() >= 0.0 and pixels.max() <= 1.0
    assert (pixels[[0, 0, -1, -1], [0, -1, 0, -1], 3] == 0.0).all(), "the corners are transparent"
    below = pixels[60, 100]
    assert below == pytest.approx([*result_picture.srgb([0.8, 0.4, 0.2]), 1.0], abs=5e-3)
    radius = (0.5 - result_picture.MARGIN) * size
    # The length of a cosine lobe is the square root of the cosine: filled just inside, line there, empty beyond.
    for angle in (-60.0, -20.0, 0.0, 30.0, 70.0):
        across, up = np.sin(np.radians(angle)), np.cos(np.radians(angle))
        inside, line, beyond = (
            pixels[int(100 + length * up), int(100 + length * across)]
            for length in (radius * np.sqrt(up) + offset for offset in (-5.0, 0.0, 5.0)))
        assert inside[:3] == pytest.approx(result_picture.EXACT, abs=0.05) and inside[3] > 0.7, angle
        assert line[:3].min() > 0.8 and line[3] > 0.9, angle
        if angle:  # the lobe touches the rim at the normal
            assert beyond[3] < 0.4, angle
    dot = pixels[int(100 + radius * np.cos(np.radians(40.0))), int(100 - radius * np.sin(np.radians(40.0)))]
    assert dot == pytest.approx([1.0] * 4), "the viewer"


def test_pixels_of_a_sheet(sheet):
    size = 200
    pixels = result_picture.lobe_picture(sheet, 1, size, ink=(0.0, 0.0, 0.0))
    ray = pixels[int(100 - 60 * np.cos(np.radians(40.0))), int(100 + 60 * np.sin(np.radians(40.0)))]
    assert ray[:3] == pytest.approx(result_picture.EXACT, abs=0.05) and ray[3] > 0.9
    assert pixels[40, 100, 3] == 0.0, "no color below a sheet"


def test_pixels_of_the_albedo(matte):
    size = 200
    pixels = result_picture.albedo_picture(matte, size, ink=(1.0, 1.0, 1.0))
    low, high = result_picture.MARGIN * size, (1.0 - result_picture.MARGIN) * size
    for value, color in zip((0.8, 0.4, 0.2), result_picture.CHANNELS, strict=True):
        assert pixels[int(low + (high - low) * value), 120] == pytest.approx([*color, 1.0], abs=0.02)
    assert pixels[int(low + (high - low) * 0.62), 120, 3] == 0.0


def test_grey_has_one_line_in_the_ink():
    curves = {"angles": [0.0, 90.0], "reflectance": [GREY, GREY], "transmittance": None}
    assert result_picture.albedo_picture(curves, 200, (0.2, 0.3, 0.4))[100, 120, :3] == pytest.approx(
        (0.2, 0.3, 0.4), abs=1e-3)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The ball of the result's picture against sums over the whole studio."""

import numpy as np
import pytest

import lamina
from lamina.baking.report import lit_ball, result_picture
from lamina.baking.report.result_curves import result_curves

POINTS = [(0.3, 2.2), (0.7, 0.5), (1.1, -1.2), (0.0, 0.0)]  # (view angle, azimuth on the picture)
COUNT = 400_000


def every_direction():
    """Spiral points on the sphere, of equal solid angles."""
    k = np.arange(COUNT)
    z, azimuth = 1.0 - (2.0 * k + 1.0) / COUNT, k * np.pi * (3.0 - np.sqrt(5.0))
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(azimuth), r * np.sin(azimuth), z], axis=1)


def summed(lut, angle, azimuth):
    """The radiance of a point of the ball without specular reflection: a sum over all directions of light."""
    normal = np.array([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)])
    lights = every_direction()
    mu_i = lights @ normal
    lights, mu_i = lights[mu_i > 1e-4], mu_i[mu_i > 1e-4]
    # dphi is 0 where the light comes from the side away from the viewer
    across, away = lights - mu_i[:, None] * normal, np.cos(angle) * normal - [0.0, 0.0, 1.0]
    size = np.linalg.norm(across, axis=1) * np.linalg.norm(away)
    dphi = np.arccos(np.clip(across @ away / np.where(size > 0.0, size, 1.0), -1.0, 1.0))
    values = lut.evaluate(np.cos(angle), mu_i, dphi) * (mu_i * lit_ball.radiance(lights))[:, None]
    return values.sum(axis=0) * 4.0 * np.pi / COUNT


def ball_of(stack, **how):
    lut = lamina.bake(stack, "preview", **how)
    return lut, result_curves(stack, lut)


def shown(curves, angle, azimuth):
    return lit_ball.colors_at(curves["ball"], curves["ball_mirrored"], np.array([angle]), np.array([azimuth]))[0]


@pytest.mark.parametrize(("stack", "error"), [
    (lamina.Stack([lamina.Medium(albedo=0.5, tau=0.0)], base=lamina.Lambert([0.8, 0.4, 0.2])), 0.02),
    (lamina.Stack([], base=lamina.Conductor(eta=0.2, k=3.0, alpha=0.3)), 0.03),
    (lamina.Stack([lamina.Interface(1.5, 0.15)], base=lamina.Lambert([0.1, 0.3, 0.5])), 0.03),
], ids=["matte", "metal", "satin"])
def test_a_point_has_the_light_of_the_whole_studio(stack, error):
    lut, curves = ball_of(stack)
    for point in POINTS:
        assert shown(curves, *point) == pytest.approx(summed(lut, *point), rel=error, abs=4e-3), point


def test_a_mirror_shows_the_studio():
    _, curves = ball_of(lamina.Stack([], base=lamina.Conductor(eta=0.1, k=6.0)))
    lamp = lit_ball.LAMP / np.linalg.norm(lit_ball.LAMP)
    half = lamp + [0.0, 0.0, 1.0]
    half /= np.linalg.norm(half)
    found = shown(curves, np.arccos(half[2]), np.arctan2(half[1], half[0]))
    assert found == pytest.approx(np.array(curves["reflectance"][6]) * lit_ball.radiance(lamp), rel=0.02)
    assert shown(curves, 0.4, -1.5) == pytest.approx(np.array(curves["reflectance"][4]) * lit_ball.FLOOR, rel=0.02)


def test_a_clear_sheet_shows_what_is_behind():
    _, curves = ball_of(lamina.Stack([lamina.Medium(albedo=0.0, tau=float(np.log(2.0)))]))
    assert shown(curves, 0.0, 0.0) == pytest.approx([0.5 * lit_ball.HORIZON] * 3, rel=0.02)


def test_a_brushed_metal_has_a_highlight_across_the_brushing():
    metal = lamina.Conductor(eta=0.2, k=3.0, alpha=0.08, alpha_v=0.4)  # brushed horizontally
    _, curves = ball_of(lamina.Stack([], base=metal), basis="moving")
    half = lit_ball.LAMP / np.linalg.norm(lit_ball.LAMP) + [0.0, 0.0, 1.0]
    x, y, _ = half / np.linalg.norm(half)

    def at(dx, dy):
        return shown(curves, np.arcsin(np.hypot(x + dx, y + dy)), np.arctan2(y + dy, x + dx)).mean()

    assert at(0.0, 0.25) > 1.3 * at(0.25, 0.0) and at(0.0, -0.25) > 1.3 * at(-0.25, 0.0)


def test_pixels_of_the_ball():
    _, curves = ball_of(lamina.Stack([], base=lamina.Lambert([0.8, 0.4, 0.2])))
    size = 200
    ball = result_picture.ball_picture(curves, size)
    assert ball.shape == (size, size, 4) and ball[5, 5, 3] == 0.0 and ball[100, 100, 3] == 1.0
    assert ball[100, 100, :3] == pytest.approx(result_picture.srgb(shown(curves, 0.0, 0.0)), abs=0.01)
    assert ball[140, 70, 0] > ball[60, 70, 0] + 0.1, "the lamp and the sky are above; rows start at the bottom"

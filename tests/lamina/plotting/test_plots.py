# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots: the lines on the axes hold the numbers that the functions give."""

import functools
import math
import sys

import matplotlib
import numpy as np
import pytest

import lamina
from lamina import ArgumentError, HenyeyGreenstein, Lambert, Medium, Stack, plot

matplotlib.use("Agg")
SHEET = Stack([Medium(0.9, 1.0, HenyeyGreenstein(0.5)), Medium(0.5, 0.3)])
PAINT = Stack([Medium([0.9, 0.8, 0.6], 1.0)], Lambert([0.5, 0.3, 0.1]))


@functools.cache
def both(stack):
    return lamina.solve(stack, "preview"), lamina.bake(stack, "preview")


@pytest.fixture(autouse=True)
def closed():
    yield
    matplotlib.pyplot.close("all")


def at(line, angle):
    x, y = line.get_data()
    return float(np.interp(angle, x, y))


def test_lobes_are_cosine_weighted_values():
    exact, lut = both(PAINT)
    ax = plot.lobes(exact, lut, mu_o=[0.8, 0.4])
    lines = ax.get_lines()
    assert len(lines) == 2 * 2 * 3  # exact and fitted, two views, three channels
    angle = math.radians(40.0)
    mu = math.cos(angle)
    for number, subject in ((0, exact.brdf), (6, lut.evaluate)):
        for channel in range(3):
            assert at(lines[number + channel], angle) == pytest.approx(subject(0.8, mu, 0.0)[channel] * mu, rel=2e-3)
            assert at(lines[number + 3 + channel], -angle) == pytest.approx(
                subject(0.4, mu, math.pi)[channel] * mu, rel=2e-3)
    assert len(plot.lobes(lut, channel=1).get_lines()) == 1


def test_the_sample_of_the_guide_is_no_spike():
    """The slab of docs/python.md, along the normal and oblique. For the view along the normal, the pole of the closures
    of light straight through was 14 times as long as the lobe. For the oblique view it is a thin spike."""
    slab = Stack([Medium(0.9, 2.0, HenyeyGreenstein(0.75))])
    exact, lut = both(slab)
    solid, dashed = ([np.nanmax(line.get_ydata()) for line in plot.lobes(one, mu_o=[1.0, 0.5]).get_lines()]
                     for one in (exact, lut))
    assert np.all(np.array(dashed) < 2.0 * np.array(solid)), (dashed, solid)


def test_light_through_a_sheet_is_below_the_horizon():
    exact, _ = both(SHEET)
    (line,) = plot.lobes(exact, mu_o=0.6).get_lines()
    x, y = line.get_data()
    below = x > np.pi / 2
    ahead, mu = math.pi - 0.5, math.cos(0.5)
    found = float(np.interp(ahead, x[below][::-1], y[below][::-1]))
    assert found == pytest.approx(exact.btdf(0.6, mu, 0.0, "bottom")[0] * mu, rel=2e-3)


def test_albedos():
    exact, lut = both(SHEET)
    lines = plot.albedos(exact, lut).get_lines()
    mu = math.cos(math.radians(30.0))
    wanted = [exact.reflectance(mu), exact.transmittance(mu), lut.reflectance(mu), lut.transmittance(mu)]
    assert [at(line, 30.0) for line in lines] == pytest.approx([one[0] for one in wanted], rel=1e-6)
    assert lines[0].get_linestyle() == "-" and lines[2].get_linestyle() == "--"


def test_errors_are_those_of_the_comparison():
    compared = both(PAINT)[1].compare()
    lines = plot.errors(compared).get_lines()
    for channel, line in enumerate(lines):
        assert line.get_ydata() == pytest.approx(100.0 * compared.errors["reflection"][0, 0, channel])


def test_the_table_has_a_strip_for_each_closure(tmp_path):
    lut = both(PAINT)[1]
    (image,) = plot.table(lut).get_images()
    picture = np.asarray(image.get_array())
    assert picture.shape == (len(lut.closures), 64, 3) and picture.max() == pytest.approx(1.0)
    assert picture**2 * lut.weights.max() == pytest.approx(lut.weights[0, :, 0], abs=1e-6)
    figure = plot.compare(lut)
    figure.savefig(tmp_path / "figure.png", dpi=40)
    assert len(figure.axes) == 4 and (tmp_path / "figure.png").stat().st_size > 5000


def test_a_preset_and_given_axes():
    axes = matplotlib.pyplot.subplot(projection="polar")
    assert plot.lobes("soot-on-brick", ax=axes) is axes and axes.get_lines()


@pytest.mark.parametrize(("call", "words"), [
    (lambda: plot.lobes(3), "what = 3: must be a ScatteringFunction, a Lut, or a stack"),
    (lambda: plot.lobes(both(PAINT)[0], mu_o=0.0), "mu_o = 0: must lie in"),
    (lambda: plot.lobes(both(PAINT)[0], channel=3), "channel = 3: must be a whole number from 0 to 2"),
    (lambda: plot.table(PAINT), "lut = .*: must be a Lut"),
    (lambda: plot.table(both(PAINT)[1], side="bottom"), "side = 'bottom': must be 'top'"),
    (lambda: plot.lobes(both(PAINT)[0], ax=matplotlib.pyplot.subplot()), "ax = .*: must be polar axes"),
    (lambda: plot.albedos(both(PAINT)[0], ax=5), "ax = 5: must be rectangular axes of matplotlib"),
    (lambda: plot.lobes(both(PAINT)[0], mu_o=[]), "mu_o = \\[\\]: must hold a cosine"),
])
def test_bad_arguments(call, words):
    with pytest.raises(ArgumentError, match=words):
        call()


def test_without_matplotlib_one_sentence(monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(lamina.ExtraMissing) as caught:
        plot.albedos(both(PAINT)[0])
    assert str(caught.value) == "lamina.plot needs matplotlib, which is not installed: pip install matplotlib"
    assert isinstance(caught.value, ImportError)

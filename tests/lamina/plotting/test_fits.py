# SPDX-License-Identifier: GPL-3.0-or-later
"""The plot of a fit holds the values and the standard errors of the fit."""

import matplotlib
import numpy as np
import pytest

import lamina
from lamina import Free, Medium, Stack, Template, plot
from lamina.measurements import Reflectance, Transmittance

matplotlib.use("Agg")


def test_fitted():
    solved = lamina.solve(Stack([Medium(albedo=[0.9, 0.7, 0.5], tau=1.0)]))
    mu = np.array([0.3, 0.6, 0.9])
    measured = [Reflectance(values=solved.reflectance(mu) + 0.01, sigma=0.02, mu_i=mu),
                Transmittance(values=solved.transmittance(mu), relative=0.1, mu_i=mu)]
    fit = lamina.fit(measured, Template([Medium(albedo=[0.9, 0.7, Free(0.4, 0.0, 1.0)], tau=Free(2.0, 0.1, 9.0))]))
    ax = plot.fitted(fit)
    assert len(ax.containers) == 6  # two measurements of three channels
    for container, (number, channel) in zip(ax.containers, np.ndindex(2, 3), strict=True):
        points, _, (bars,) = container
        x, y = points.get_data()
        assert x.tolist() == fit.fitted[number][:, channel].tolist()
        assert y.tolist() == measured[number].values[:, channel].tolist()
        lengths = [segment[1][1] - segment[0][1] for segment in bars.get_segments()]
        assert lengths == pytest.approx(2.0 * fit.sigmas[number][:, channel])
    assert fit.sigmas[1] == pytest.approx(0.1 * fit.fitted[1])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["Reflectance, 9 values",
                                                                         "Transmittance, 9 values"]
    with pytest.raises(lamina.ArgumentError, match="fit = 1: must be what lamina.fit returned"):
        plot.fitted(1)
    matplotlib.pyplot.close("all")

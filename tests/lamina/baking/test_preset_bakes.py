# SPDX-License-Identifier: GPL-3.0-or-later
"""Every preset of the library bakes at preview quality, with its known fit error; overlays over red plastic."""

import statistics

import numpy as np
import pytest

from lamina import PrincipledBase, Retroreflector, Stack, bake, presets
from lamina.kinds.table import SHAPE, TILT, strips_of

# Fit errors that presets may reach, mean and worst slice; some are known to be hard, each for a reason.
MEAN, WORST = 0.06, 0.16
HARD = {
    "frosted-glass": (0.18, 0.38),  # a rough sheet without scattering inside: two narrow lobes on either side
    "dusty-bronze": (0.08, 0.24),  # one choice of closures for dust from clean to thick
    "dusty-lacquer": (0.06, 0.31),
    "dusty-car-paint": (0.06, 0.33),
    "mars-dust-on-solar-cell": (0.06, 0.36),
    "ash-on-basalt": (0.06, 0.29),
    "car-paint-silver": (0.075, 0.13),  # flakes under a coat: lobes that move with the view fit them with 1.4 %
    "car-paint-deep-blue": (0.07, 0.1),
    "car-paint-copper": (0.07, 0.13),  # with lobes that move 2.2 %
    "car-paint-blue-red-pearl": (0.08, 0.19),  # with lobes that move 2.8 %
    "car-paint-green-gold-pearl": (0.07, 0.15),  # with lobes that move 1.9 %
    "velvet-red": (0.085, 0.16),  # dark along the normal; lobes that move with the view fit it with 5 %
    "tarnished-silver": (0.075, 0.26),  # a strongly absorbing layer over a narrow lobe
}
OVERLAY = (0.065, 0.45)  # over glossy plastic; the same reason as for dusty bronze
MEAN_OF_USUAL = 0.0175  # of all presets with a base that are not in HARD
PLASTIC = PrincipledBase(color=(0.6, 0.02, 0.015), roughness=0.15)
THROUGH, THROUGH_WORST, THROUGH_OF_ALL = 0.28, 0.55, 0.16


@pytest.fixture(scope="module")
def reports():
    """Filled by the test of each preset, for the test of all."""
    return {}


@pytest.mark.parametrize("name", presets.names())
def test_a_preset_bakes(name, reports):
    stack = presets.load(name)
    if stack.category == "Overlays":
        stack = Stack(stack.layers, PLASTIC, category=stack.category)
    moves = stack.is_oriented or isinstance(stack.base, Retroreflector)  # no closure of one shape serves them
    lut = bake(stack, "preview", basis="moving" if moves else "standard")
    weights = lut.weights[:, [strip.role not in (SHAPE, TILT) for strip in strips_of(lut.header)]]
    assert np.all(np.isfinite(weights)) and weights.min() >= 0.0 and weights.max() > 0.0
    report = reports[name] = lut.report
    mean, worst = OVERLAY if stack.category == "Overlays" else HARD.get(name, (MEAN, WORST))
    assert report["fit_error"] < mean and report["worst_slice"]["error"] < worst
    assert report["albedo_error"] < 1e-3 and report["energy_error"] < 1e-3
    through = report["fit_error_transmission"]
    assert (through is None) == (stack.base is not None)
    assert through is None or (through < THROUGH and report["worst_slice_transmission"]["error"] < THROUGH_WORST)


def test_all_presets_together(reports):
    if len(reports) < len(presets.names()):
        pytest.skip("only some presets were baked")
    reports = {entry.id: reports[entry.id] for entry in presets.entries() if entry.category != "Overlays"}
    usual = [report["fit_error"] for name, report in reports.items() if name not in HARD]
    assert statistics.fmean(usual) < MEAN_OF_USUAL
    through = [report["fit_error_transmission"] for report in reports.values()]
    assert statistics.fmean(error for error in through if error is not None) < THROUGH_OF_ALL

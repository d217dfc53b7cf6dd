# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust of several moments, such as the frames of an animation, on one surface: the sum of all that settled."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..common.errors import DustError, quoted
from .settle import Dust
from .statistics import Statistics

_SUMMED = ("rays", "seconds", "mean", "arrived", "deposited", "slid", "wiped", "launched", "fell", "behind", "stopped",
           "missed", "grains")


def accumulate(moments: Sequence[Dust]) -> Dust:
    """The Dust that settled in all `moments`, at the same points in the same order. Dust stays where it settled: it
    does not slide when a later moment has steeper slopes. tau, arrived and back are sums, in float32.

    The statistics are sums too, except: `maximum` and `covered` are those of the sum, `covered` as a share of the
    points, and `fell_stderr` is that of independent estimates. `settings` and `seed` are those of the first moment.
    Raises DustError for no moments, and for moments whose points differ."""
    if not isinstance(moments, Sequence) or not all(isinstance(dust, Dust) for dust in moments):
        raise DustError(f"moments = {quoted(moments)}: must be a list of what lamina.dust.settle returned")
    if not moments:
        raise DustError("moments is empty: must hold the dust of at least one moment")
    first = moments[0]
    for number, dust in enumerate(moments[1:], 1):
        if not _same_points(first, dust):
            raise DustError(f"moments[{number}] lies on other points than moments[0]: the mesh must keep its vertices, "
                            "faces and sharp edges")
    tau, arrived = (_sum([getattr(dust, name) for dust in moments]) for name in ("tau", "arrived"))
    back = None if first.back is None else _sum([dust.back for dust in moments])
    return replace(first, tau=tau, arrived=arrived, back=back, statistics=_statistics(moments, tau))


def _same_points(a: Dust, b: Dust) -> bool:
    pairs = ((a.vertices, b.vertices), (a.corners, b.corners))
    alike = all(x is y is None or x is not None and y is not None and np.array_equal(x, y) for x, y in pairs)
    return alike and a.tau.shape == b.tau.shape and (a.back is None) == (b.back is None)


def _sum(arrays: Sequence) -> np.ndarray:
    return np.sum(arrays, axis=0, dtype=np.float64).astype(np.float32)


def _statistics(moments: Sequence[Dust], tau: np.ndarray) -> Statistics:
    each = [dust.statistics for dust in moments]
    summed: dict[str, Any] = {}
    for name in _SUMMED:
        values = [getattr(one, name) for one in each]
        summed[name] = None if None in values else sum(values)
    amount = sum(dust.settings.tau for dust in moments)
    return replace(
        each[0], **summed, maximum=float(tau.max(initial=0.0)),
        covered=float(np.mean(tau > 0.01 * amount)) if tau.size else 0.0,
        fell_stderr=math.sqrt(sum(one.fell_stderr**2 for one in each)),
        keepers=_union(one.keepers for one in each), notes=_union(one.notes for one in each))


def _union(lists) -> tuple[str, ...]:
    return tuple(dict.fromkeys(text for texts in lists for text in texts))

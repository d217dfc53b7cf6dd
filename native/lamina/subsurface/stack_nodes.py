# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of Cycles' Subsurface Scattering node for a stack: its light that travels sideways, relightable."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import _core
from ..common.errors import StackError
from ..common.progress import Progress
from ..kinds.bases import HalfSpace
from ..kinds.boundaries import Interface
from ..kinds.fields import channel
from ..lateral.searchlight import Searchlight, searchlight
from ..material.layers import Medium
from ..material.stack import Stack
from ..solver.solve import solve
from .node_inputs import SubsurfaceInputs, subsurface_inputs
from .node_parameters import LEAST_IOR
from .node_response import LARGEST_G


def subsurface_nodes(stack: Stack, version: tuple[int, int] = (4, 5), mu: float = 1.0, quality: str = "final",
                     progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> SubsurfaceInputs:
    """Inputs with which Cycles' Subsurface Scattering node stands for a stack, lengths in millimetres.

    A boundary on top of the stack stays a boundary: a Glossy closure by its Fresnel reflectance over the node, which
    gets its `ior` and its width as `roughness`. All other light that the stack reflects becomes exit albedo and mean
    exit distance of the node, one per channel, for a view at the cosine `mu`, in (0, 1]. The node's anisotropy is the
    mean cosine of the topmost medium, within [0, .9] and over channels; it has the two wanted values at any anisotropy.

    Arguments and errors are those of searchlight and subsurface_inputs. Raises StackError for a half-space or layer
    that absorbs nothing and reflects its light at an infinite mean distance."""
    beam = searchlight(stack, mu, quality, progress=progress, cancel=cancel)
    on_top, ior, roughness = boundary_on_top(stack, mu, quality)
    distance = require_finite_distance(beam, on_top)
    albedo = np.clip((beam.reflectance - on_top) / (1.0 - on_top), 0.0, 1.0)
    return subsurface_inputs(albedo, distance, _anisotropy(stack), version, mu, ior, roughness)


def boundary_on_top(stack: Stack, mu, quality: str) -> tuple[np.ndarray, float, float]:
    """(light that a boundary on top of the stack reflects before any enters, at the cosine or cosines `mu`, last axis
    channels; its index, 1.01 for none; its width alpha), the latter two as Cycles' node takes them."""
    shape = (*np.shape(mu), stack.channels)
    if not stack.layers or not isinstance(stack.layers[0], Interface):
        return np.zeros(shape), LEAST_IOR, 0.0
    top = stack.layers[0]
    ior, alpha = (float(np.mean([channel(value, c) for c in range(stack.channels)])) for value in (top.ior, top.alpha))
    on_top = np.broadcast_to(solve(Stack([top]), quality).reflectance(mu), shape)
    return on_top, float(np.clip(ior, LEAST_IOR, 3.8)), min(alpha, 1.0)


def require_finite_distance(beam: Searchlight, on_top: np.ndarray) -> np.ndarray:
    """Mean exit distance of the light below the boundary, by channel. Raises StackError where it is infinite."""
    inside = beam.reflectance - on_top
    with np.errstate(divide="ignore", invalid="ignore"):
        way = np.where(inside > 1e-9, beam.reflectance * beam.mean_distance / inside, 0.0)
    if not np.all(np.isfinite(way)):
        index = int(np.flatnonzero(~np.isfinite(way))[0])
        raise StackError(f"channel {index}: light that nothing absorbs leaves at an infinite mean distance, must meet "
                         "a sigma_a above 0 or a base that absorbs")
    return way


def _anisotropy(stack: Stack) -> float:
    """Mean cosine of the topmost medium's phase function, over channels, within the table's range."""
    media = [layer for layer in (*stack.layers, stack.base) if isinstance(layer, Medium | HalfSpace)]
    if not media:
        return 0.0
    cosines = [float(_core.PhaseFunction(*media[0].phase.in_channel(c)).moment(1)) for c in range(stack.channels)]
    return float(np.clip(np.mean(cosines), 0.0, LARGEST_G))

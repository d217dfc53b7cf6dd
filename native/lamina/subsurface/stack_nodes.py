# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of Cycles' Subsurface Scattering node that reproduce the lateral light transport of a stack."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from .. import _core
from ..common.errors import StackError
from ..common.progress import Progress
from ..kinds.bases import Conductor, HalfSpace, PrincipledBase, Retroreflector
from ..kinds.boundaries import Interface
from ..kinds.fields import channel
from ..kinds.limits import MOST_NODE_IOR
from ..lateral.searchlight import Searchlight, searchlight
from ..material.any_stack import AnyStack, as_stack
from ..material.layers import Medium
from ..material.stack import Stack
from ..solver.solve import solve
from .depth_colours import exit_colours
from .node_inputs import SubsurfaceInputs, subsurface_inputs
from .node_parameters import LEAST_IOR
from .node_response import LARGEST_G

# A metal base is refused if this share of light can cross the media twice without a collision.
MOST_MIRRORED = 0.01


def subsurface_nodes(stack: AnyStack, version: tuple[int, int] = (4, 5), mu: float = 1.0, quality: str = "final",
                     progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> SubsurfaceInputs:
    """Inputs with which Cycles' Subsurface Scattering node represents a stack, lengths in millimetres.

    A boundary on top of the stack is rendered by a Glossy closure, weighted by Fresnel reflectance, above the node. The
    node gets the boundary's `ior`, and its width as `roughness`. All other reflected light determines the node's exit
    albedo and mean exit distance, one per channel, for a view at the cosine `mu`, in (0, 1]. The node's anisotropy is
    the mean cosine of the topmost medium, averaged over channels and clamped to [0, .9]; exit albedo and mean distance
    match at any anisotropy. Values of a stack with wavelengths are red, green and blue: the color of the exit albedo,
    and the mean distance of a channel's light.

    Arguments and errors are those of searchlight and subsurface_inputs. Raises StackError for a half-space or layer
    without absorption, whose mean exit distance is infinite, and for a metal base that the media do not hide."""
    stack = as_stack(stack)
    stack.require_isotropic("subsurface scattering")
    stack.require_no_flakes("subsurface scattering")
    require_hidden_metal(stack)
    beam = searchlight(stack, mu, quality, progress=progress, cancel=cancel)
    on_top, ior, roughness = boundary_on_top(stack, mu, quality)
    distance = require_finite_distance(beam, on_top)
    albedo = np.clip((beam.reflectance - on_top) / (1.0 - on_top), 0.0, 1.0)
    albedo, distance = exit_colours(stack, albedo, distance)
    return subsurface_inputs(albedo, distance, _anisotropy(stack), version, mu, ior, roughness)


def boundary_on_top(stack: Stack, mu, quality: str) -> tuple[np.ndarray, float, float]:
    """(reflectance of a boundary on top of the stack at the cosine or cosines `mu`, last axis channels; the boundary's
    index, 1.01 for none; its width alpha). Index and width are in the form of the inputs of Cycles' node."""
    shape = (*np.shape(mu), stack.channels)
    if not stack.layers or not isinstance(stack.layers[0], Interface):
        return np.zeros(shape), LEAST_IOR, 0.0
    top = stack.layers[0]
    ior, alpha = (float(np.mean([channel(value, c) for c in range(stack.channels)])) for value in (top.ior, top.alpha))
    on_top = np.broadcast_to(solve(Stack([top]), quality).reflectance(mu), shape)
    return on_top, float(np.clip(ior, LEAST_IOR, MOST_NODE_IOR)), min(alpha, 1.0)


def require_hidden_metal(stack: Stack) -> None:
    """Raises StackError if light can reach a metal or a retroreflector and leave without a collision in a medium:
    this light is a lobe, which closures for light that travels sideways would show as diffuse."""
    base = stack.base
    word = "retroreflector" if isinstance(base, Retroreflector) else "metal"
    if not (isinstance(base, Conductor | Retroreflector) or (isinstance(base, PrincipledBase) and base.metallic > 0.0)):
        return
    media = [number for number, layer in enumerate(stack.layers) if isinstance(layer, Medium)]
    for index in range(stack.channels):
        crossing = math.exp(-2.0 * sum(stack.optics(number, index)[1] for number in media))
        if crossing > MOST_MIRRORED:
            raise StackError(f"{stack.channel_name(index)}: the base is a {word}, and {100.0 * crossing:.3g} % of the "
                             f"light can reach it and return without scattering: must be at most "
                             f"{100.0 * MOST_MIRRORED:g} %, by media above it, for light that travels sideways")


def require_finite_distance(beam: Searchlight, on_top: np.ndarray) -> np.ndarray:
    """Mean exit distance of the light below the boundary, by channel. Raises StackError if a distance is infinite."""
    inside = beam.reflectance - on_top
    with np.errstate(divide="ignore", invalid="ignore"):
        way = np.where(inside > 1e-9, beam.reflectance * beam.mean_distance / inside, 0.0)
    if not np.all(np.isfinite(way)):
        index = int(np.flatnonzero(~np.isfinite(way))[0])
        raise StackError(f"{beam.stack.channel_name(index)}: light that nothing absorbs leaves at an infinite mean "
                         "distance, must meet a sigma_a above 0 or a base that absorbs")
    return way


def _anisotropy(stack: Stack) -> float:
    """Mean cosine of the topmost medium's phase function, averaged over channels and clamped to the table's range."""
    media = [layer for layer in (*stack.layers, stack.base) if isinstance(layer, Medium | HalfSpace)]
    if not media:
        return 0.0
    cosines = [float(_core.PhaseFunction(*media[0].phase.in_channel(c)).moment(1)) for c in range(stack.channels)]
    return float(np.clip(np.mean(cosines), 0.0, LARGEST_G))

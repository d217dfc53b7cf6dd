# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole bakes and whole layers of dust on a Dask cluster, one per call: neither splits into parts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ..baking.bake import bake
from ..baking.lut import Lut
from ..common.errors import ArgumentError, quoted
from ..common.progress import Progress
from ..kinds.dust import Settling
from ..material.any_stack import AnyStack, as_stack
from ..settling.mesh import Mesh
from ..settling.settle import Dust, settle
from .gather import gather


def bakes(client, stacks: Sequence[AnyStack], quality: str = "final", basis: str = "standard",
          progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> list[Lut]:
    """lamina.bake of each of the stacks, on the cluster of `client`: the same tables in the same order. Raises
    ExtraMissing without Dask, ArgumentError, and what lamina.bake raises."""
    if isinstance(stacks, str) or not isinstance(stacks, Sequence):
        raise ArgumentError(f"stacks = {quoted(stacks)}: must be a list of stacks")
    given = [(as_stack(stack),) for stack in stacks]
    return gather(client, _bake, given, (quality, basis), "the bakes", progress, cancel)


def settle_each(client, surfaces: Sequence[Mesh], occluders: Iterable[Mesh] = (), settings: Settling | None = None,
                seed: int = 0, progress: Progress | None = None,
                cancel: Callable[[], bool] | None = None) -> list[Dust]:
    """lamina.dust.settle on each of the surfaces, with all other surfaces and the `occluders` in the way, on the
    cluster of `client`. Raises ExtraMissing without Dask, ArgumentError, and what lamina.dust.settle raises."""
    if not isinstance(surfaces, Sequence):
        raise ArgumentError(f"surfaces = {quoted(surfaces)}: must be a list of meshes")
    return gather(client, _settle, [(number,) for number in range(len(surfaces))],
                  (list(surfaces), list(occluders), settings, seed), "the dust", progress, cancel)


def _bake(quality, basis, stack):
    return bake(stack, quality, threads=1, basis=basis)


def _settle(surfaces, occluders, settings, seed, number):
    others = [mesh for place, mesh in enumerate(surfaces) if place != number]
    return settle(surfaces[number], None, [*others, *occluders], settings, seed, threads=1)

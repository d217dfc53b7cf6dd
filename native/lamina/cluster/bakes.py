# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes on a Dask cluster, one per call: a bake does not split into parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..baking.bake import bake
from ..baking.table.lut import Lut
from ..common.errors import ArgumentError, quoted
from ..common.progress import Progress
from ..material.any_stack import AnyStack, as_stack
from .gather import gather


def bakes(client, stacks: Sequence[AnyStack], quality: str = "final", basis: str = "standard",
          progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> list[Lut]:
    """lamina.bake of each of the stacks, on the cluster of `client`: the same tables in the same order. Raises
    ExtraMissing without Dask, ArgumentError, and what lamina.bake raises."""
    if isinstance(stacks, str) or not isinstance(stacks, Sequence):
        raise ArgumentError(f"stacks = {quoted(stacks)}: must be a list of stacks")
    given = [(as_stack(stack),) for stack in stacks]
    return gather(client, _bake, given, (quality, basis), "the bakes", progress, cancel)


def _bake(quality, basis, stack):
    return bake(stack, quality, threads=1, basis=basis)

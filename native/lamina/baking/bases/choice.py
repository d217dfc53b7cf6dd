# SPDX-License-Identifier: GPL-3.0-or-later
"""The class that bakes a stack, and how large the table can become, for the estimate of a file's growth."""

from __future__ import annotations

from ...kinds.bases import Lambert, ShaderBase
from ...kinds.table import AZIMUTH_ROWS, COLUMNS, TAU_ROWS, TAU_ROWS_OF_AZIMUTH
from ...material.stack import Stack
from ..fit.slices import covers_inputs, shows_bsdf
from .base import BakedBase
from .colored import Colored
from .covered import Covered
from .fixed import Fixed
from .job import CLOSURE_BASES
from .principled import Principled
from .shader import Shader


def kind_of(stack: Stack) -> type[BakedBase]:
    """The class for the stack's kind of base."""
    if shows_bsdf(stack):
        return Principled
    if covers_inputs(stack):
        return Covered
    if isinstance(stack.base, ShaderBase):
        return Shader
    return Colored if isinstance(stack.base, Lambert) and stack.base.textured else Fixed


def largest_size(stack: Stack, basis: str) -> tuple[int, int]:
    """(height, width) of the largest image that the table of this stack and basis can have, in texels, with that of
    the stack without the film of its varying interface: see Lut.image."""
    varies = stack.varying is not None
    if stack.is_oriented:
        rows = max(AZIMUTH_ROWS.values()) * (TAU_ROWS_OF_AZIMUTH if varies else 1)
    else:
        rows = TAU_ROWS if varies else 1
    bare = stack.uncovered
    more = 0 if bare is None else largest_size(bare, basis)[0]
    return rows * kind_of(stack).most_strips(stack, CLOSURE_BASES[basis]) + more, COLUMNS

# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a lookup table can become, for the estimate of a file's growth before a bake."""

from __future__ import annotations

from ..kinds.bases import Lambert, PrincipledBase, ShaderBase
from ..kinds.table import COLUMNS, ROUGHNESS_ROWS, TAU_ROWS
from ..material.stack import Stack
from .bake import CLOSURE_BASES
from .principled_base import is_shown


def largest_size(stack: Stack, basis: str) -> tuple[int, int]:
    """(height, width) of the largest image that the table of this stack and basis can have, in texels: see
    Lut.image."""
    limits = CLOSURE_BASES[basis]
    rows = TAU_ROWS if stack.varying is not None else 1
    if is_shown(stack):
        assert isinstance(stack.base, PrincipledBase)
        rows *= ROUGHNESS_ROWS if "roughness" in stack.base.inputs else 1
        ends = 2 if "metallic" in stack.base.inputs else 1
        return rows * (1 + ends * (sum(limits.principled) + 2)), COLUMNS  # the BSDF; its rests, and what is thrown back
    strips = limits.reflected[2] + 1  # and the mirror
    if stack.varying is not None:
        strips += limits.reflected[0]  # closures of the row without the varying layer
    if stack.base is None:
        return 2 * rows * (strips + limits.transmitted[2] + 1), COLUMNS  # both sides; and the unscattered light
    if isinstance(stack.base, ShaderBase) or (isinstance(stack.base, Lambert) and stack.base.textured):
        strips += limits.textured_base[2] + 2  # and two that weigh the light from below
    return rows * strips, COLUMNS

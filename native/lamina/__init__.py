# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamina: scattering functions of layered materials, and lookup tables of them for Cycles."""

from .bake import bake
from .errors import Cancelled, LutError, SolveError, StackError
from .layers import Black, HalfSpace, Lambert, Medium
from .lut import Lut
from .phase import HenyeyGreenstein, Isotropic, Rayleigh
from .solve import ScatteringFunction, solve
from .stack import Stack

__all__ = [
    "Black",
    "Cancelled",
    "HalfSpace",
    "HenyeyGreenstein",
    "Isotropic",
    "Lambert",
    "Lut",
    "LutError",
    "Medium",
    "Rayleigh",
    "ScatteringFunction",
    "SolveError",
    "Stack",
    "StackError",
    "bake",
    "solve",
]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamina: scattering functions of layered materials, and lookup tables of them for Cycles."""

from . import _core, colours, dust, export, lobes, metals, ply, presets, rgl
from .baking.bake import bake
from .baking.lut import Lut
from .common.errors import (
    ArgumentError,
    Cancelled,
    DustError,
    DustUnavailable,
    ExportError,
    LutError,
    ShardError,
    SolveError,
    StackError,
    UnknownName,
)
from .material.layers import Black, Conductor, HalfSpace, Interface, Lambert, Medium
from .material.phase import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    HenyeyGreenstein,
    Isotropic,
    Mixture,
    Rayleigh,
    Tabulated,
)
from .material.profile import Knot
from .material.stack import Stack
from .solver.solve import ScatteringFunction, solve
from .walks.estimate import Estimate, Query, estimate

__version__ = _core.__version__  # of pyproject.toml

__all__ = [
    "ArgumentError",
    "Black",
    "Cancelled",
    "Conductor",
    "CornetteShanks",
    "DoubleHenyeyGreenstein",
    "Draine",
    "DustError",
    "DustUnavailable",
    "Estimate",
    "ExportError",
    "HalfSpace",
    "HenyeyGreenstein",
    "Interface",
    "Isotropic",
    "Knot",
    "Lambert",
    "Lut",
    "LutError",
    "Medium",
    "Mixture",
    "Query",
    "Rayleigh",
    "ScatteringFunction",
    "ShardError",
    "SolveError",
    "Stack",
    "StackError",
    "Tabulated",
    "UnknownName",
    "bake",
    "colours",
    "dust",
    "estimate",
    "export",
    "lobes",
    "metals",
    "ply",
    "presets",
    "rgl",
    "solve",
]

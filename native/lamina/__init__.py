# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamina: scattering functions of layered materials, and lookup tables of them for Cycles."""

from . import colours, dust, export, metals, presets, rgl
from .bake import bake
from .errors import (
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
from .estimate import Estimate, Query, estimate
from .estimate_searchlight import SearchlightEstimate, SearchlightQuery, estimate_searchlight
from .layers import Black, Conductor, HalfSpace, Interface, Lambert, Medium
from .lut import Lut
from .phase import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    HenyeyGreenstein,
    Isotropic,
    Mixture,
    Rayleigh,
    Tabulated,
)
from .profile import Knot
from .searchlight import Searchlight, searchlight
from .solve import ScatteringFunction, solve
from .stack import Stack

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
    "Searchlight",
    "SearchlightEstimate",
    "SearchlightQuery",
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
    "estimate_searchlight",
    "export",
    "metals",
    "presets",
    "rgl",
    "searchlight",
    "solve",
]

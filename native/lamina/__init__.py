# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamina: scattering functions of layered materials, and lookup tables of them for Cycles."""

from . import _core, colours, distributed, dust, export, lobes, measurements, metals, pigments, plot, ply, presets, rgl
from .baking.bake import bake
from .baking.table.lut import Lut
from .common.errors import (
    ArgumentError,
    Cancelled,
    DustError,
    DustUnavailable,
    ExportError,
    InteriorError,
    LutError,
    MeasurementError,
    ShardError,
    SolveError,
    StackError,
    UnknownName,
)
from .common.extras import ExtraMissing
from .interior.end_material import EndMaterial
from .interior.estimates import ExitEstimate, LightEstimate
from .interior.grid import Interior
from .interior.lamps import AreaLamp, Lamp, PointLamp, SpotLamp, Surroundings
from .interior.marble import Marble, marble
from .interior.occluders import Occluders
from .interior.of_stack import interior_of_stack
from .interior.parts import WalkPart, light_in_mesh, merge_walks, walk_in_mesh, walk_part
from .interior.problem import Surface
from .interior.solid import Solid
from .inverse.fit import fit
from .inverse.free import Free
from .inverse.nearest import Nearest, nearest
from .inverse.result import Fit
from .inverse.template import Template
from .kinds import bases as _bases
from .kinds import phases as _phases
from .kinds.bases import *  # noqa: F403 - each base
from .kinds.boundaries import Interface
from .kinds.fibers import Fibers
from .kinds.films import Film
from .kinds.flakes import Flakes
from .kinds.phases import *  # noqa: F403 - each phase function
from .kinds.spectra import WAVELENGTHS, Spectrum
from .lateral.searchlight import Searchlight, searchlight
from .maps.lit import LitImages, lit_images
from .maps.relightable import RelightableImages, relightable_images
from .material.layers import Medium
from .material.phase import Mixture, Tabulated
from .material.profile import Knot
from .material.stack import Stack
from .sampling.sampler import DrawnLight, Sampler
from .solver.solve import ScatteringFunction, solve
from .subsurface.node_inputs import SubsurfaceInputs, subsurface_inputs
from .subsurface.portal import PortalTables, portal_tables
from .subsurface.stack_nodes import subsurface_nodes
from .walks.estimate import Estimate, Query, estimate
from .walks.estimate_searchlight import SearchlightEstimate, SearchlightQuery, estimate_searchlight

__version__ = _core.__version__  # of pyproject.toml

__all__ = [
    *_bases.__all__,
    *_phases.__all__,
    "AreaLamp",
    "ArgumentError",
    "Cancelled",
    "DrawnLight",
    "DustError",
    "DustUnavailable",
    "EndMaterial",
    "Estimate",
    "ExitEstimate",
    "ExportError",
    "ExtraMissing",
    "Fibers",
    "Film",
    "Fit",
    "Flakes",
    "Free",
    "Interface",
    "Interior",
    "InteriorError",
    "Knot",
    "Lamp",
    "LightEstimate",
    "LitImages",
    "Lut",
    "Marble",
    "LutError",
    "MeasurementError",
    "Medium",
    "Mixture",
    "Nearest",
    "Occluders",
    "PointLamp",
    "PortalTables",
    "Query",
    "RelightableImages",
    "Sampler",
    "ScatteringFunction",
    "Searchlight",
    "SearchlightEstimate",
    "SearchlightQuery",
    "ShardError",
    "Solid",
    "SolveError",
    "Spectrum",
    "SpotLamp",
    "Stack",
    "StackError",
    "SubsurfaceInputs",
    "Surface",
    "Surroundings",
    "Tabulated",
    "Template",
    "UnknownName",
    "WAVELENGTHS",
    "WalkPart",
    "bake",
    "colours",
    "distributed",
    "dust",
    "estimate",
    "estimate_searchlight",
    "export",
    "fit",
    "interior_of_stack",
    "light_in_mesh",
    "lit_images",
    "lobes",
    "marble",
    "measurements",
    "merge_walks",
    "metals",
    "nearest",
    "pigments",
    "plot",
    "ply",
    "portal_tables",
    "presets",
    "relightable_images",
    "rgl",
    "searchlight",
    "solve",
    "subsurface_inputs",
    "subsurface_nodes",
    "walk_in_mesh",
    "walk_part",
]


def __dir__():
    return [*__all__, "__version__"]

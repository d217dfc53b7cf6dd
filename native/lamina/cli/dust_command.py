# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `dust`: a mesh file in, the thickness of dust on its vertices out."""

from __future__ import annotations

import argparse
import math
from dataclasses import asdict, replace
from pathlib import Path

from ..common.archive import save_archive
from ..common.errors import DustError
from ..settling import ply
from ..settling.settings import MOST_SPREAD, Settling
from ..settling.settle import Dust, settle

_DOWN = {"x": (-1.0, 0.0, 0.0), "y": (0.0, -1.0, 0.0), "z": (0.0, 0.0, -1.0)}


def add(commands, run) -> None:
    """Adds the command's words to a parser; `run(arguments)` is what it will call."""
    command = commands.add_parser("dust", help="settle dust on a mesh")
    command.add_argument("mesh", metavar="MESH.ply", help="triangles or larger faces, in metres; .ply or .ply.gz")
    command.add_argument("-o", "--output", required=True, metavar="OUT",
                         help="the arrays to write (.npz): tau and arrived, one a vertex and more for vertices at "
                              "sharp edges; vertices, which each is at; corners, which each triangle's corners have; "
                              "and a header of JSON")
    amount = command.add_mutually_exclusive_group()
    amount.add_argument("--amount", type=float, help="optical thickness on an open horizontal plate (1)")
    amount.add_argument("--grams", type=float, help="areal mass there in g/m^2 instead")
    command.add_argument("--material", default="dust-saharan-1.7um", help="which dust, for --grams")
    command.add_argument("--up", choices=sorted(_DOWN), default="z", help="the axis that points up (z)")
    command.add_argument("--spread", type=float, default=35.0, help="half-angle of the fall in degrees (35)")
    command.add_argument("--wind", type=float, nargs=3, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "Z"),
                         help="velocity of the wind over that of the fall")
    command.add_argument("--repose", type=float, default=45.0, help="angle of repose in degrees (45)")
    command.add_argument("--sharp", type=float, default=30.0,
                         help="angle between faces in degrees, above which their edge is sharp (30)")
    command.add_argument("--coverage", type=float, default=1.0, help="share of the surface that is left dusty (1)")
    command.add_argument("--two-sided", action="store_true", help="dust lies on either side of faces")
    command.add_argument("--occluder", action="append", default=[], metavar="MESH.ply", help="what else is in the way")
    command.add_argument("--rays", type=int, default=256, help="rays a vertex (256)")
    command.add_argument("--seed", type=int, default=0)
    command.add_argument("--threads", type=int, default=0, help="0: all")
    command.add_argument("--quiet", action="store_true", help="no progress")
    command.set_defaults(run=run)


def settled(arguments: argparse.Namespace, progress) -> Dust:
    """What the words of the command ask for. Raises DustError, DustUnavailable, MeshFileError, OSError."""
    for name, most in (("spread", math.degrees(MOST_SPREAD)), ("repose", 180.0), ("sharp", 180.0)):
        value = getattr(arguments, name)
        if not 0.0 <= value <= most:
            raise DustError(f"--{name} {value:g}: must lie in [0, {most:.2f}] degrees".replace(".00]", "]"))
    settings = Settling(
        amount=arguments.amount, grams=arguments.grams, extinction=arguments.material, gravity=_DOWN[arguments.up],
        spread=math.radians(arguments.spread), wind=tuple(arguments.wind), repose=math.radians(arguments.repose),
        coverage=arguments.coverage, two_sided=arguments.two_sided, rays=arguments.rays)
    occluders = [ply.load(path) for path in arguments.occluder]
    mesh = replace(ply.load(arguments.mesh), sharp_angle=math.radians(arguments.sharp))
    return settle(mesh, None, occluders, settings, arguments.seed, progress, threads=arguments.threads)


def save(found: Dust, path: str | Path) -> None:
    """Arrays tau, arrived, vertices and corners, those of lamina.dust.Dust, and a header as JSON. Raises OSError."""
    header = {"format": "lamina-dust", "schema": 1, "seed": found.seed, "settings": asdict(found.settings),
              "statistics": asdict(found.statistics)}
    save_archive(path, header, tau=found.tau, arrived=found.arrived, vertices=found.vertices, corners=found.corners)

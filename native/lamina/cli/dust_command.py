# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `dust`: from a mesh file to the thickness of dust on its vertices."""

from __future__ import annotations

import argparse
import math
from dataclasses import asdict, fields, replace
from pathlib import Path

from ..common.archive import save_archive
from ..common.errors import DustError
from ..kinds.dust import OPTIONS, DustOption, Settling
from ..settling import ply
from ..settling.settle import Dust, settle
from .arguments import add_seed, add_threads
from .output import check_writable, progress_of

_DOWN = {"x": (-1.0, 0.0, 0.0), "y": (0.0, -1.0, 0.0), "z": (0.0, 0.0, -1.0)}
_DEFAULTS: dict = {member.name: member.default for member in fields(Settling)}


def add(commands) -> None:
    """Adds the command to a parser."""
    command = commands.add_parser("dust", help="settle dust on a mesh")
    command.add_argument("mesh", metavar="MESH.ply", help="triangles or larger faces, in metres; .ply or .ply.gz")
    command.add_argument("-o", "--output", required=True, metavar="OUT",
                         help="the arrays to write (.npz): tau and arrived for each vertex, and again for vertices at "
                              "sharp edges; vertices, the vertex of each of these points; corners, the point of each "
                              "triangle's corners; and a JSON header")
    amount = command.add_mutually_exclusive_group()
    amount.add_argument("--amount", type=float, help="optical thickness on an open horizontal plate (1)")
    amount.add_argument("--grams", type=float, help="areal mass on that plate in g/m^2, instead of --amount")
    command.add_argument("--material", default=_DEFAULTS["extinction"], help="the dust's substance, for --grams")
    command.add_argument("--up", choices=sorted(_DOWN), default="z", help="the axis that points up (z)")
    command.add_argument("--wind", type=float, nargs=3, default=_DEFAULTS["wind"], metavar=("X", "Y", "Z"),
                         help="velocity of the wind relative to the speed of the fall")
    command.add_argument("--sharp", type=float, default=30.0,
                         help="angle between faces in degrees, above which their edge is sharp (30)")
    for option in _flags():
        _add_flag(command, option)
    command.add_argument("--occluder", action="append", default=[], metavar="MESH.ply", help="a mesh that shelters")
    add_seed(command)
    add_threads(command)
    command.add_argument("--quiet", action="store_true", help="no progress")
    command.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> int:
    output = Path(arguments.output)
    check_writable(output)
    progress = progress_of(arguments)
    found = _settled(arguments, progress)
    if progress is not None:
        progress.end()
    _save(found, output)
    if not arguments.quiet:
        print(f"{arguments.mesh}: {found.statistics}")
        for note in found.statistics.notes:
            print(note)
    return 0


def _flags() -> list[DustOption]:
    return [option for option in OPTIONS if option.help]


def _add_flag(command: argparse.ArgumentParser, option: DustOption) -> None:
    flag, default = "--" + option.name.replace("_", "-"), _DEFAULTS[option.name]
    if option.switch:
        command.add_argument(flag, action="store_true", help=option.help)
    elif option.unit == "rad":
        degrees = math.degrees(default)
        command.add_argument(flag, type=float, default=degrees, help=f"{option.help} in degrees ({degrees:g})")
    else:
        usual = "" if default is None else f" ({default:g})"
        command.add_argument(flag, type=int if option.whole else float, default=default, help=option.help + usual)


def _settled(arguments: argparse.Namespace, progress) -> Dust:
    """The dust that the arguments ask for. Raises DustError, DustUnavailable, MeshFileError, OSError."""
    angles = {option.name: math.degrees(option.high) for option in _flags() if option.unit == "rad"}
    for name, most in {**angles, "sharp": 180.0}.items():
        value = getattr(arguments, name)
        if not 0.0 <= value <= most:
            raise DustError(f"--{name.replace('_', '-')} {value:g}: must lie in [0, {most:.2f}] degrees".replace(
                ".00]", "]"))
    numbers: dict = {option.name: getattr(arguments, option.name) for option in _flags()}
    numbers |= {name: math.radians(numbers[name]) for name in angles}
    settings = Settling(
        amount=arguments.amount, grams=arguments.grams, extinction=arguments.material, gravity=_DOWN[arguments.up],
        wind=tuple(arguments.wind), **numbers)
    occluders = [ply.load(path) for path in arguments.occluder]
    mesh = replace(ply.load(arguments.mesh), sharp_angle=math.radians(arguments.sharp))
    return settle(mesh, None, occluders, settings, arguments.seed, progress, threads=arguments.threads)


def _save(found: Dust, path: str | Path) -> None:
    """Arrays tau, arrived, vertices and corners, those of lamina.dust.Dust, and a header as JSON. Raises OSError."""
    header = {"format": "lamina-dust", "schema": 1, "seed": found.seed, "settings": asdict(found.settings),
              "statistics": asdict(found.statistics)}
    assert found.vertices is not None and found.corners is not None  # None for given points alone
    save_archive(path, header, tau=found.tau, arrived=found.arrived, vertices=found.vertices, corners=found.corners)

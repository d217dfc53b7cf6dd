# SPDX-License-Identifier: GPL-3.0-or-later
"""The grid of the study: homogeneous slabs and pairs of directions."""

import math
from dataclasses import dataclass

from walks import Slab

ALBEDOS = (0.5, 0.9, 0.99, 1.0)
TAUS = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0)
GS = (0.0, 0.8, -0.3)
# Name: (mu_o, mu_i, dphi); light comes in at mu_i, and dphi = 0 is forward. The value is symmetric in mu_o and mu_i.
# Light comes in at the grazing cosine, because the transfer walk is then 2 to 25 times as efficient.
DIRECTIONS = {
    "normal / normal": (1.0, 1.0, 0.0),
    "normal / grazing": (1.0, 0.1, 0.0),
    "60° / 60°, 0°": (0.5, 0.5, 0.0),
    "60° / 60°, 90°": (0.5, 0.5, math.pi / 2),
    "60° / 60°, 180°": (0.5, 0.5, math.pi),
}


@dataclass(frozen=True)
class Cell:
    number: int  # within the whole grid
    slab: Slab
    directions: str

    def columns(self) -> dict:
        """The columns that identify the cell in tables."""
        return {"albedo": self.slab.albedo, "tau": self.slab.tau, "g": self.slab.g, "directions": self.directions}


def cells() -> list[Cell]:
    """All cells, those of one slab together."""
    slabs = [Slab(albedo, tau, g) for g in GS for albedo in ALBEDOS for tau in TAUS]
    return [Cell(number, slab, name) for number, (slab, name) in
            enumerate((slab, name) for slab in slabs for name in DIRECTIONS)]


def quick() -> list[Cell]:
    """Two cells: one isotropic, one peaked."""
    wanted = {(Slab(0.9, 1.0, 0.0), "60° / 60°, 90°"), (Slab(0.9, 0.5, 0.8), "normal / normal")}
    return [cell for cell in cells() if (cell.slab, cell.directions) in wanted]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes whose shape stands in the table: those of isotropic stacks, see moving_lobes, and those of anisotropic ones,
see oriented_lobes. The latter depend on the azimuth `phi_o` of the viewer, which is None for the former."""

from __future__ import annotations

import numpy as np

from . import moving_lobes, oriented_lobes
from .closure_table import LightGrid


def ids(count: int, oriented: bool) -> list[str]:
    return [f"{oriented_lobes.PREFIX if oriented else moving_lobes.PREFIX}{number}" for number in range(count)]


def is_shaped(name: str) -> bool:
    return name.startswith((moving_lobes.PREFIX, oriented_lobes.PREFIX))


def is_oriented(name: str) -> bool:
    return name.startswith(oriented_lobes.PREFIX)


def values(shape: np.ndarray, mu_o, mu_i, dphi, phi_o=None) -> np.ndarray:
    """f * |cos theta_i| in 1/sr; `shape` [..., numbers] broadcasts with the cosines and azimuths."""
    if phi_o is None:
        return moving_lobes.values(shape, mu_o, mu_i, dphi)
    return oriented_lobes.values(shape, mu_o, mu_i, dphi, phi_o)


def albedos(shape: np.ndarray, mu_o: np.ndarray, phi_o=None) -> np.ndarray:
    """Directional albedos above the surface; `shape` [..., numbers] and the others broadcast."""
    return moving_lobes.albedos(shape, mu_o) if phi_o is None else oriented_lobes.albedos(shape, mu_o, phi_o)


def sampled(shape: np.ndarray, mu_o: np.ndarray, phi_o: float | None, grid: LightGrid) -> np.ndarray:
    """`values` of shapes [view, numbers] at views `mu_o` [view] of one azimuth, on a grid of lights: [view, light]."""
    if phi_o is None:
        return moving_lobes.sampled(shape, mu_o, grid.mu, grid.dphi)
    return oriented_lobes.sampled(shape, mu_o, phi_o, grid.mu, grid.dphi)

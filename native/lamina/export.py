# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering functions as arrays with axes, in .npz files."""

from .exchange.export import Export, default_angles, default_azimuths, load_npz, save_npz, tabulate

__all__ = ["Export", "default_angles", "default_azimuths", "load_npz", "save_npz", "tabulate"]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from PLY files."""

from .common.errors import MeshFileError
from .settling.ply import load

__all__ = ["MeshFileError", "load"]

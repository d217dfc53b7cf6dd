# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name."""

from .kinds.metals import GRAZING, reflectance
from .material.metals import colours_of, conductor, flakes, indices_of, names, source

__all__ = ["GRAZING", "colours_of", "conductor", "flakes", "indices_of", "names", "reflectance", "source"]

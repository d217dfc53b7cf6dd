# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name."""

from .material.metals import GRAZING, colours_of, conductor, indices_of, names, reflectance, source

__all__ = ["GRAZING", "colours_of", "conductor", "indices_of", "names", "reflectance", "source"]

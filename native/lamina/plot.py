# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots of scattering functions and lookup tables. They need matplotlib: pip install matplotlib."""

from .plotting.curves import albedos, errors
from .plotting.fits import fitted
from .plotting.lobes import lobes
from .plotting.tables import compare, table

__all__ = ["albedos", "compare", "errors", "fitted", "lobes", "table"]

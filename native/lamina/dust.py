# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles on meshes: see lamina.settling."""

from .common.errors import DustError
from .kinds.dust import ATTRIBUTE, Settling
from .settling.accumulate import accumulate
from .settling.mesh import Mesh, Points
from .settling.settle import Dust, available, settle, settle_image
from .settling.statistics import Statistics
from .settling.texels import dilate, texel_points

__all__ = ["ATTRIBUTE", "Dust", "DustError", "Mesh", "Points", "Settling", "Statistics", "accumulate",
           "available", "dilate", "settle", "settle_image", "texel_points"]

# SPDX-License-Identifier: GPL-3.0-or-later
"""The perceived colour of a medium, the albedo for a colour, and the colour of a spectrum."""

from .common.observer import rec709
from .material.colours import albedo_of, shown

__all__ = ["albedo_of", "rec709", "shown"]

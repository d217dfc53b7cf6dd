# SPDX-License-Identifier: GPL-3.0-or-later
"""The perceived colour of a medium, the medium for a colour or for two, and the colour of a spectrum."""

from .common.observer import rec709
from .material.colours import albedo_of, shown
from .material.match import match, match_coats

__all__ = ["albedo_of", "match", "match_coats", "rec709", "shown"]

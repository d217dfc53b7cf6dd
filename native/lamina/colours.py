# SPDX-License-Identifier: GPL-3.0-or-later
"""The perceived colour of a medium, and the albedo for a colour."""

from .material.colours import albedo_of, shown

__all__ = ["albedo_of", "shown"]

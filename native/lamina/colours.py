# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour that a medium shows, and the albedo behind a colour."""

from .material.colours import albedo_of, shown

__all__ = ["albedo_of", "shown"]

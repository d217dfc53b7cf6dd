# SPDX-License-Identifier: GPL-3.0-or-later
"""Constants of the lookup table that both its writer and the node group need."""

from __future__ import annotations

COLUMNS = 64  # view angles
TAU_ROWS = 33  # thicknesses of a varying layer
# Rows are uniform in t = tau / (tau + TAU_BEND): thin layers change fastest and so have the most rows.
TAU_BEND = 0.5
# Strips that a textured base weighs: closures after this prefix, and the share of diffuse light from the base that the
# layers throw back to it.
PREFIX = "base/"
THROWN_BACK = "base/thrown back"

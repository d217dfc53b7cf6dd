# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of the light in interiors: images over a UV map, or values of vertices."""

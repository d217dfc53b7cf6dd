# SPDX-License-Identifier: GPL-3.0-or-later
"""The lobes of Cycles' closures, and their values on the grid of a bake."""

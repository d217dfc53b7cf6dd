# SPDX-License-Identifier: GPL-3.0-or-later
"""The lobes that Cycles' closures stand for, and their values on the grid of a bake."""

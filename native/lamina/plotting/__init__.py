# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots with matplotlib: the parts of lamina.plot."""

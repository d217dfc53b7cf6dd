# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots with matplotlib: the code of lamina.plot."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions of light drawn for a view, for renderers."""

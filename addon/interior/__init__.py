# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumetric interiors of Blender objects."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain functions that edit a material's stack: layers, files, presets, metals."""

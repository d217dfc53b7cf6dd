# SPDX-License-Identifier: GPL-3.0-or-later
"""Interiors of meshes: coefficients in voxels, marble veins, and random walks of light."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""What is inside of a mesh: coefficients in voxels, veins, and walks of light."""

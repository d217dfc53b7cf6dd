# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements for lamina.fit, and their files."""

from .inverse.measurements import Brdf, Btdf, Profile, Reflectance, Transmittance

__all__ = ["Brdf", "Btdf", "Profile", "Reflectance", "Transmittance"]

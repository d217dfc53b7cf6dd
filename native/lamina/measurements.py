# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements for lamina.fit, and their files."""

from .inverse.files import load
from .inverse.measurements import Brdf, Btdf, Measurement, Profile, Reflectance, Transmittance

__all__ = ["Brdf", "Btdf", "Measurement", "Profile", "Reflectance", "Transmittance", "load"]

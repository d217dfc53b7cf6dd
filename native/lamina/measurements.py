# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements for lamina.fit, measured bases, and their files."""

from .inverse.files import load
from .inverse.measured_base import load_base
from .inverse.measurements import Brdf, Btdf, Measurement, Profile, Reflectance, Transmittance

__all__ = ["Brdf", "Btdf", "Measurement", "Profile", "Reflectance", "Transmittance", "load", "load_base"]

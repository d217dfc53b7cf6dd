# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering functions as .bsdf files for Mitsuba and other readers of the RGL format."""

from .exchange.rgl import check_wavelengths, incident_angles, save_bsdf

__all__ = ["check_wavelengths", "incident_angles", "save_bsdf"]

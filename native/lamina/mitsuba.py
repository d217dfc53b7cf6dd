# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks as a BSDF plugin of Mitsuba 3. Needs the package mitsuba."""

from .sampling.mitsuba_bsdf import bsdf, register
from .sampling.render_table import RenderTable

__all__ = ["RenderTable", "bsdf", "register"]

# SPDX-License-Identifier: GPL-3.0-or-later
"""The fields of a medium, and the forms in which it may be given. The medium itself: see lamina.material.layers."""

from __future__ import annotations

import math

from .fields import Field, Form
from .panel import Item, Panel
from .pigments import PIGMENT

ALBEDO = Field("albedo", 0.0, 1.0, panel=Panel(
    "Albedo", "Share of the light that a scattering event keeps, per channel", 0.8, rgb=True, subtype="COLOR"))
COLOR = Field("color", 0.0, 1.0, panel=Panel(
    "Color", "What the layer shows under diffuse light: infinitely thick, or over the given base", 0.8, rgb=True,
    subtype="COLOR", prop="colour", words="color"))
SIGMA_S = Field("sigma_s", 0.0, 1e12, unit="1/mm", panel=Panel(
    "Scattering (1/mm)", "Scattering coefficient in 1/mm, per channel", 1.0, high=1e6, soft_high=20.0, precision=4,
    step=10, rgb=True, words="scattering"))
SIGMA_A = Field("sigma_a", 0.0, 1e12, unit="1/mm", panel=Panel(
    "Absorption (1/mm)", "Absorption coefficient in 1/mm, per channel", 0.1, high=1e6, soft_high=20.0, precision=4,
    step=10, rgb=True, words="absorption"))
TAU = Field("tau", 0.0, math.inf, infinite=True, panel=Panel(
    "Optical Thickness", "Mean number of events straight through: 0.1 is a veil, 1 is dusty, 10 hides the base", 1.0,
    high=1e6, soft_high=20.0, step=10, precision=3, words="optical thickness"))
THICKNESS = Field("thickness", 0.0, math.inf, unit="mm", infinite=True, panel=Panel(
    "Thickness (mm)", "Thickness of the layer in millimetres", 1.0, high=1e6, soft_high=10.0, step=10, precision=4))
OVER = Field("over", 0.0, 1.0, optional=True, panel=Panel(
    "Over", "Reflectance of the base over which the color is meant", 0.5, rgb=True, subtype="COLOR",
    words="color of the base below"))
AMOUNT = Field("amount", 0.0, 1e9, single=True, panel=Panel(
    "Amount", "Amount of the pigment; what 1 means, the list of pigments tells", 0.1, high=1e4, soft_high=1.0,
    precision=4, step=1))
DEPTH = Field("depth", 0.0, 1.0)

# In the order of the panel's list.
BY_COLOUR = Form((COLOR, OVER, TAU), Item("colour", "Color", "By the color that it shows, and optical thickness", 2),
                 local=(COLOR,))
BY_ALBEDO = Form((ALBEDO, TAU), Item("optical", "Albedo", "By albedo and optical thickness", 0), local=(ALBEDO,))
BY_COEFFICIENTS = Form((SIGMA_S, SIGMA_A, THICKNESS), Item(
    "coefficients", "Per mm", "By scattering and absorption per millimetre, and thickness", 1),
    local=(SIGMA_S, SIGMA_A))
BY_PIGMENT = Form((PIGMENT, AMOUNT, SIGMA_S, THICKNESS), Item(
    "pigment", "Pigment", "By a pigment with a published spectrum, scattering per millimetre, and thickness", 3),
    local=(PIGMENT, AMOUNT, SIGMA_S))
FORMS = (BY_COLOUR, BY_ALBEDO, BY_PIGMENT, BY_COEFFICIENTS)
IN_MM = {form.item.id for form in FORMS if THICKNESS in form.fields and form.item is not None}
USUAL_FORM = BY_ALBEDO

ITEM = Item("medium", "Medium", "Scattering, absorbing particles: dust, pigment, haze", 0, icon="MATFLUID")


def single_scattering_albedo(sigma_s: float, sigma_a: float) -> float:
    """sigma_s / sigma_t; 0 without scattering and absorption."""
    sigma_t = sigma_s + sigma_a
    return sigma_s / sigma_t if sigma_t > 0.0 else 0.0

# SPDX-License-Identifier: GPL-3.0-or-later
"""Substances that absorb, by name. Their published spectra: see lamina.pigments."""

from __future__ import annotations

from .fields import Option
from .panel import Item

# Of each: the meaning of amount 1.
ITEMS = (
    Item("oxyhemoglobin", "Blood, with Oxygen", "Arterial blood; 1 is whole blood, 150 g/L of oxyhemoglobin", 1),
    Item("deoxyhemoglobin", "Blood, without Oxygen", "Venous blood; 1 is whole blood, 150 g/L of deoxyhemoglobin", 2),
    Item("melanin", "Melanin", "The brown of skin and hair; at 1 melanosomes fill a tenth of the volume", 3),
    Item("chlorophyll", "Chlorophyll", "The green of leaves; 1 is 2 g/L, as in a green leaf", 4),
    Item("carotenoids", "Carotenoids", "Yellow and orange of leaves and fruits; 1 is 0.5 g/L, as in a leaf", 5),
    Item("anthocyanins", "Anthocyanins", "Red and purple of leaves, berries and wine; 1 is 0.5 g/L", 6),
    Item("brown-pigments", "Tannins", "The brown of dead leaves, tea and wood; 1 is a dead leaf", 7),
    Item("water", "Water", "Pure water, blue after meters", 8),
    Item("iron-oxide", "Iron Oxide", "Rust and red ocher, finely ground; 1 is 1 % of the volume", 9),
    Item("cadmium-yellow", "Cadmium Yellow", "Cadmium sulfide, finely ground; 1 is 1 % of the volume", 10),
    Item("rhodamine", "Rhodamine", "A pink dye, Rhodamine 6G; 1 is 1 % of the volume", 11),
)
PIGMENT = Option("pigment", tuple(item.id for item in ITEMS), "Pigment", "The substance that absorbs, by its published "
                 "spectrum: its hue changes with the thickness, as of real dyes", ITEMS)

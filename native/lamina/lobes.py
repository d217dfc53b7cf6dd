# SPDX-License-Identifier: GPL-3.0-or-later
"""The lobes of Cycles closures: their formulas, and the recipes from which nodes are built."""

from .closures.lobe import Lobe, NodeRecipe
from .closures.lobes import (
    DICTIONARY,
    by_id,
    diffuse,
    directional_albedo,
    recipe,
    sheen_ashikhmin,
    toon,
    toon_glossy,
    translucent,
)
from .closures.microfacet_lobes import beckmann, fresnel_ggx, ggx, mirror
from .closures.through_lobes import through

__all__ = ["DICTIONARY", "Lobe", "NodeRecipe", "beckmann", "by_id", "diffuse", "directional_albedo", "fresnel_ggx",
           "ggx", "mirror", "recipe", "sheen_ashikhmin", "through", "toon", "toon_glossy", "translucent"]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures made of microfacets: GGX and Beckmann, with and without Fresnel's factor, and mirrors.

Smith masking is height-correlated, as in Cycles. These closures are always about the normal: Cycles 4.5 samples tilted
microfacets wrongly.
"""
from __future__ import annotations

import numpy as np

from ..common.arguments import check_field
from ..common.fresnel import fresnel
from ..kinds.fields import Field
from .lobe import ASIDE, INCOMING, Geometry, Lobe, NodeRecipe, number

# Cycles limits the Anisotropy of a Glossy BSDF to this.
MOST_ANISOTROPY = 0.99
ROUGHNESS = Field("roughness", 0.0, 1.0, above=True)
ANISOTROPY = Field("anisotropy", -MOST_ANISOTROPY, MOST_ANISOTROPY)
IOR = Field("ior", 0.0, 100.0, above=True)
SHARP = Field("roughness", 0.0, 1.0)


def _smith_lambda(x, y, z, alpha_x, alpha_y):
    """Smith's Lambda of the GGX distribution for the direction (x, y, z)."""
    slope2 = ((alpha_x * x) ** 2 + (alpha_y * y) ** 2) / np.maximum(z * z, 1e-300)
    return 0.5 * (np.sqrt(1.0 + slope2) - 1.0)


def ggx_reflection(g: Geometry, alpha_x, alpha_y):
    """D G2 / (4 mu_o) with height-correlated Smith masking; x is the plane of incidence.

    For alpha_x = alpha_y = 1 this is mu_i / (2 pi (mu_o + mu_i)), the law of Lommel and Seeliger.
    """
    masking = 1.0 + _smith_lambda(g.sin_o, 0.0, g.mu_o, alpha_x, alpha_y)
    masking = masking + _smith_lambda(g.light_x, g.light_y, g.mu_i, alpha_x, alpha_y)
    return _ggx_facets(g, alpha_x, alpha_y) / (4.0 * g.mu_o * masking)


def _ggx_facets(g: Geometry, alpha_x, alpha_y):
    """The distribution D of facet normals, at the half vector."""
    half_x, half_y, half_z = g.sin_o + g.light_x, g.light_y, g.mu_o + g.mu_i
    length2 = half_x**2 + half_y**2 + half_z**2
    stretched = (half_x / alpha_x) ** 2 + (half_y / alpha_y) ** 2 + half_z**2
    return (length2 / stretched) ** 2 / (np.pi * alpha_x * alpha_y)


def _ggx_density(alpha_x, alpha_y):
    """Density of reflected directions, with sampling of visible normals (Heitz 2018): D G1 / (4 mu_o)."""

    def density(mu_o, mu_i, dphi):
        g = Geometry(mu_o, mu_i, dphi)
        seen = 1.0 + _smith_lambda(g.sin_o, 0.0, g.mu_o, alpha_x, alpha_y)
        return _ggx_facets(g, alpha_x, alpha_y) / (4.0 * g.mu_o * seen)

    return density


def widths(roughness, anisotropy):
    """(alpha in the plane of incidence, alpha across) of a Glossy BSDF with these values of its sockets, if its tangent
    is the incoming direction."""
    alpha, squeeze = roughness**2, 1.0 - np.abs(anisotropy)
    narrow, wide = alpha * squeeze, np.minimum(1.0, alpha / squeeze)  # Cycles clamps alpha to 1
    return np.where(anisotropy > 0.0, narrow, wide), np.where(anisotropy > 0.0, wide, narrow)


def ggx(roughness: float, anisotropy: float = 0.0, name: str = "") -> Lobe:
    """Glossy BSDF, distribution GGX (never Multiscatter), without Fresnel; `roughness` in (0, 1].

    Positive `anisotropy`, of [-0.99, 0.99], makes it narrow in the plane of incidence and wide across it: the tangent
    is the incoming direction, so the lobe turns with the viewer. Raises ArgumentError.
    """
    roughness, anisotropy = check_field(roughness, ROUGHNESS), check_field(anisotropy, ANISOTROPY)
    alpha_x, alpha_y = widths(roughness, anisotropy)

    def evaluate(mu_o, mu_i, dphi):
        return ggx_reflection(Geometry(mu_o, mu_i, dphi), alpha_x, alpha_y)

    name = name or f"ggx_{number(roughness)}" + (f"_a{number(anisotropy)}" if anisotropy else "")
    node = NodeRecipe(
        "ShaderNodeBsdfAnisotropic",
        inputs={"Roughness": roughness, "Anisotropy": anisotropy, "Rotation": 0.0},
        enums={"distribution": "GGX"},
        vectors={"Tangent": ASIDE} if anisotropy else {},
    )
    density = _ggx_density(alpha_x, alpha_y)
    return Lobe(name, "reflection", evaluate, node, narrow=roughness < 0.65, density=density)


def halo(alpha: float, name: str = "") -> Lobe:
    """Glossy BSDF, distribution GGX, whose lobe about the mirror direction is round at every view: the halo of light
    that a layer scatters forward above a mirror.

    A half vector that is off by d across the plane of incidence turns the direction by 2 d mu_o, one in the plane by
    2 d. The widths of the facets are therefore `alpha` in the plane and alpha / mu_o across it, both at most 1. Tangent
    and Anisotropy are as in `ggx`, with 1 - Anisotropy = sqrt(mu_o) and Roughness^2 = alpha / sqrt(mu_o).
    """

    def widths(mu_o):
        squeeze = np.maximum(np.sqrt(np.asarray(mu_o, float)), 1.0 - MOST_ANISOTROPY)
        mean = np.minimum(alpha / squeeze, 1.0)
        return mean * squeeze, np.minimum(mean / squeeze, 1.0)

    def evaluate(mu_o, mu_i, dphi):
        return ggx_reflection(Geometry(mu_o, mu_i, dphi), *widths(mu_o))

    def density(mu_o, mu_i, dphi):
        return _ggx_density(*widths(mu_o))(mu_o, mu_i, dphi)

    node = NodeRecipe(
        "ShaderNodeBsdfAnisotropic", inputs={"Rotation": 0.0}, enums={"distribution": "GGX"},
        vectors={"Tangent": ASIDE},
        of_cosine={"Roughness": (0.0, alpha**0.5, -0.25), "Anisotropy": (1.0, -1.0, 0.5)},
    )
    return Lobe(name or f"halo_{number(alpha)}", "reflection", evaluate, node, narrow=True, density=density)


def fresnel_ggx(ior: float, roughness: float = 1.0, name: str = "") -> Lobe:
    """P(n): GGX times (F - F0) / (1 - F0), a Lommel-Seeliger lobe with a forward phase function.

    F depends on half the scattering angle alone. The node is a Principled BSDF in which all layers except the specular
    one are black. The weight is the tint of a coat of index 1 seen along its own normal, a linear factor without an
    upper limit. `ior` lies in (0, 100], `roughness` in (0, 1]. Raises ArgumentError.
    """
    ior, roughness = check_field(ior, IOR), check_field(roughness, ROUGHNESS)
    alpha = roughness**2
    normal_reflectance = ((ior - 1.0) / (ior + 1.0)) ** 2

    def evaluate(mu_o, mu_i, dphi):
        g = Geometry(mu_o, mu_i, dphi)
        share = (fresnel(g.cos_half(), ior) - normal_reflectance) / (1.0 - normal_reflectance)
        return np.maximum(share, 0.0) * ggx_reflection(g, alpha, alpha)

    black = (0.0, 0.0, 0.0, 1.0)
    node = NodeRecipe(
        "ShaderNodeBsdfPrincipled",
        weight_input="Coat Tint",
        inputs={
            "Base Color": black, "Metallic": 0.0, "Roughness": roughness, "IOR": ior,
            "Specular IOR Level": 0.5, "Specular Tint": black, "Coat Weight": 1.0, "Coat IOR": 1.0,
        },
        enums={"distribution": "GGX"},
        vectors={"Coat Normal": INCOMING},
    )
    name = name or f"p{number(ior)}" + (f"_{number(roughness)}" if roughness != 1.0 else "")
    density = _ggx_density(alpha, alpha)
    return Lobe(name, "reflection", evaluate, node, narrow=roughness < 0.65, density=density)


def beckmann(roughness: float, name: str = "") -> Lobe:
    """Glossy BSDF, distribution Beckmann, without Fresnel; Lambda by Walter's rational fit (2007), as in Cycles.
    `roughness` lies in (0, 1]. Raises ArgumentError."""
    roughness = check_field(roughness, ROUGHNESS)
    alpha = roughness**2

    def evaluate(mu_o, mu_i, dphi):
        g = Geometry(mu_o, mu_i, dphi)
        half_x, half_y, half_z = g.sin_o + g.light_x, g.light_y, g.mu_o + g.mu_i
        slope2 = (half_x**2 + half_y**2) / np.maximum(half_z**2, 1e-300) / alpha**2
        cos2 = half_z**2 / (half_x**2 + half_y**2 + half_z**2)
        density = np.exp(-slope2) / (np.pi * alpha**2 * cos2**2)
        masking = 1.0 + _beckmann_lambda(g.mu_o, alpha) + _beckmann_lambda(g.mu_i, alpha)
        return density / (4.0 * g.mu_o * masking)

    node = NodeRecipe(
        "ShaderNodeBsdfAnisotropic", inputs={"Roughness": roughness, "Anisotropy": 0.0},
        enums={"distribution": "BECKMANN"},
    )
    return Lobe(name or f"beckmann_{number(roughness)}", "reflection", evaluate, node, narrow=roughness < 0.65)


def _beckmann_lambda(cosine, alpha: float):
    a = cosine / (alpha * np.sqrt(np.maximum(1.0 - cosine**2, 1e-300)))
    return np.where(a < 1.6, (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)


def mirror(roughness: float) -> NodeRecipe:
    """Recipe of the closure for specular reflection: Glossy GGX of roughness [0, 1], sharp at 0. Raises
    ArgumentError."""
    roughness = check_field(roughness, SHARP)
    return NodeRecipe(
        "ShaderNodeBsdfAnisotropic", inputs={"Roughness": roughness, "Anisotropy": 0.0}, enums={"distribution": "GGX"}
    )

# SPDX-License-Identifier: GPL-3.0-or-later
"""The Cycles closures of the mixtures, each with its closed form and its node recipe.

Closures are defined here only. A `Lobe` holds the cosine-weighted value f * |cos theta_i| in 1/sr that one closure of
unit weight reflects or transmits, and how to build the closure from a shader node. `tests/cycles/test_lobes.py`
measures each of them in Cycles, so that a change of a closure in a Blender release is noticed.

Weights depend on the view only. Only Diffuse, Translucent and Toon closures may have tilted normals: Cycles 4.5 samples
tilted microfacets wrongly.
"""
from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..common.arguments import check_field, check_kind, check_number, cosines, finite_array
from ..common.errors import ArgumentError, UnknownName, quoted
from ..kinds.fields import Field
from . import following_lobes, moving_lobes, oriented_lobes
from .lobe import GEOMETRIC, Cone, Geometry, Lobe, NodeRecipe, Normal, number
from .microfacet_lobes import beckmann, fresnel_ggx, ggx, halo, mirror
from .through_lobes import through

SIZE, SMOOTH = Field("size", 0.0, 1.0), Field("smooth", 0.0, 1.0)
SIGMA = Field("sigma", 0.0, 1.0, above=True)


def _normal_suffix(normal: Normal) -> str:
    if isinstance(normal, tuple) and len(normal) == 2 and normal[0] in ("tilt", "lean"):
        angle = check_number(normal[1], f"normal[{quoted(normal[0])}]", "must be a finite number", math.isfinite)
        return f"_tilt{number(angle)}"
    suffixes = {"N": "", "I": "_i", "N+I": "_h"}
    if not isinstance(normal, str) or normal not in suffixes:
        raise ArgumentError(f"normal = {quoted(normal)}: must be one of {', '.join(suffixes)}, or a pair of a text and "
                            "an angle")
    return suffixes[normal]


# --- Lambert's cosine ---------------------------------------------------------------------------


def diffuse(normal: Normal = GEOMETRIC) -> Lobe:
    """Diffuse BSDF of roughness 0 about any normal: max(n.l, 0) / pi."""

    def evaluate(mu_o, mu_i, dphi):
        return np.maximum(Geometry(mu_o, mu_i, dphi).along(normal), 0.0) / np.pi

    node = NodeRecipe("ShaderNodeBsdfDiffuse", inputs={"Roughness": 0.0}, normal=normal)
    return Lobe("diffuse" + _normal_suffix(normal), "reflection", evaluate, node)


def translucent(normal: Normal = GEOMETRIC) -> Lobe:
    """Translucent BSDF, the Lambert lobe of the far side: max(-n.l, 0) / pi."""

    def evaluate(mu_o, mu_i, dphi):
        return np.maximum(-Geometry(mu_o, mu_i, dphi, below=True).along(normal), 0.0) / np.pi

    node = NodeRecipe("ShaderNodeBsdfTranslucent", normal=normal)
    return Lobe("translucent" + _normal_suffix(normal), "transmission", evaluate, node)


# --- Toon ---------------------------------------------------------------------------------------


def _toon(cosine, size: float, smooth: float):
    """A cone of half-angle `size`, then a linear ramp of width `smooth` (both over pi/2)."""
    inner, ramp = max(size, 1e-5) * np.pi / 2, smooth * np.pi / 2
    beyond = np.arccos(np.clip(cosine, 0.0, 1.0)) - inner
    intensity = np.where(beyond < 0.0, 1.0, np.clip(1.0 - beyond / ramp, 0.0, 1.0) if ramp > 0.0 else 0.0)
    solid_angle = 2.0 * np.pi * (1.0 - np.cos(min(inner + ramp, np.pi / 2)))
    return np.where(cosine >= 0.0, intensity / solid_angle, 0.0)


def _toon_density(cosine, size: float, smooth: float):
    """Density of directions: Cycles samples the cone and its ramp uniformly."""
    outer = min((max(size, 1e-5) + smooth) * np.pi / 2, np.pi / 2)
    return np.where(cosine >= np.cos(outer), 1.0 / (2.0 * np.pi * (1.0 - np.cos(outer))), 0.0)


def _along_mirror(mu_o, mu_i, dphi):
    """Cosine of the light with the mirror direction."""
    g = Geometry(mu_o, mu_i, dphi)
    return g.mu_o * g.mu_i - g.sin_o * g.light_x


def _toon_cone(size: float, smooth: float) -> Cone | None:
    inner, ramp = max(size, 1e-5) * np.pi / 2, smooth * np.pi / 2
    if ramp <= 0.0 or inner + ramp >= np.pi / 2:
        return None
    outer = inner + ramp
    return Cone(outer, (1.0 - (np.sin(outer) - np.sin(inner)) / ramp) / (1.0 - np.cos(outer)))


def toon(size: float, smooth: float, normal: Normal = GEOMETRIC, name: str = "") -> Lobe:
    """Toon BSDF, component Diffuse: a soft cone about a normal, independent of the view. `size` and `smooth` lie in
    [0, 1]. Raises ArgumentError."""
    size, smooth = check_field(size, SIZE), check_field(smooth, SMOOTH)

    def evaluate(mu_o, mu_i, dphi):
        return _toon(Geometry(mu_o, mu_i, dphi).along(normal), size, smooth)

    def density(mu_o, mu_i, dphi):
        return _toon_density(Geometry(mu_o, mu_i, dphi).along(normal), size, smooth)

    node = NodeRecipe(
        "ShaderNodeBsdfToon", inputs={"Size": size, "Smooth": smooth}, enums={"component": "DIFFUSE"},
        normal=normal,
    )
    name = name or f"toon_{number(size)}_{number(smooth)}" + _normal_suffix(normal)
    return Lobe(name, "reflection", evaluate, node, cone=_toon_cone(size, smooth), density=density)


def toon_glossy(size: float, smooth: float) -> Lobe:
    """Toon BSDF, component Glossy: a soft cone about the mirror direction. `size` and `smooth` lie in [0, 1]. Raises
    ArgumentError."""
    size, smooth = check_field(size, SIZE), check_field(smooth, SMOOTH)

    def evaluate(mu_o, mu_i, dphi):
        return _toon(_along_mirror(mu_o, mu_i, dphi), size, smooth)

    def density(mu_o, mu_i, dphi):
        return _toon_density(_along_mirror(mu_o, mu_i, dphi), size, smooth)

    node = NodeRecipe(
        "ShaderNodeBsdfToon", inputs={"Size": size, "Smooth": smooth}, enums={"component": "GLOSSY"}
    )
    return Lobe(f"toonglossy_{number(size)}_{number(smooth)}", "reflection", evaluate, node, density=density)


# --- Sheen --------------------------------------------------------------------------------------


def sheen_ashikhmin(sigma: float) -> Lobe:
    """Sheen BSDF, distribution Ashikhmin: an inverted Gaussian of half vectors with a V-groove. `sigma` lies in (0, 1].
    Raises ArgumentError."""
    sigma = check_field(sigma, SIGMA)

    def evaluate(mu_o, mu_i, dphi):
        g = Geometry(mu_o, mu_i, dphi)
        cos_between = np.maximum(g.cos_half(), 1e-5)
        cos_half2 = ((g.mu_o + g.mu_i) / (2.0 * cos_between)) ** 2
        sin_half2 = np.maximum(1.0 - cos_half2, 1e-12)
        density = np.exp(-cos_half2 / sin_half2 / sigma**2) / (np.pi * sigma**2 * sin_half2**2)
        groove = 2.0 * np.sqrt(cos_half2) / cos_between * np.minimum(g.mu_o, g.mu_i)
        return 0.25 * density * np.minimum(1.0, groove) / g.mu_o

    node = NodeRecipe(
        "ShaderNodeBsdfSheen", inputs={"Roughness": sigma}, enums={"distribution": "ASHIKHMIN"}
    )
    def density(mu_o, mu_i, dphi):
        return np.full(np.broadcast_shapes(*map(np.shape, (mu_o, mu_i, dphi))), 0.5 / np.pi)

    return Lobe(f"sheen_a_{number(sigma)}", "reflection", evaluate, node, density=density)


# --- The dictionary -----------------------------------------------------------------------------

# Found by backward elimination from 360 closures on random slabs (g from -.5 to .88, with and without a Lambertian
# base). Compared with all 360, the mean error of six closures per material is .1 percentage points higher.
# tools/choose_lobes.py repeats such a choice. Refraction BSDFs are excluded: Cycles evaluates them for half vectors
# that it never samples, so a rough one loses up to half of its light under a sky.
DICTIONARY: tuple[Lobe, ...] = (
    diffuse(),
    diffuse(("tilt", -15.0)),
    diffuse(("tilt", 15.0)),
    fresnel_ggx(1.003),
    fresnel_ggx(1.03),
    fresnel_ggx(1.06),
    fresnel_ggx(1.1),
    fresnel_ggx(1.3),
    fresnel_ggx(1.7),
    fresnel_ggx(3.0),
    fresnel_ggx(2.0, roughness=0.7),
    ggx(1.0),
    ggx(1.0, anisotropy=0.3),
    ggx(0.9, anisotropy=0.5),
    ggx(0.7, anisotropy=0.5),
    sheen_ashikhmin(0.6),
    sheen_ashikhmin(0.7),
    toon(0.01, 0.55, "I"),
    toon(0.01, 1.0, "I"),
    toon(0.15, 0.5, "N+I"),
    toon(0.15, 0.2, ("tilt", 60.0)),
    toon(0.6, 0.3, ("tilt", 15.0)),
    toon(0.75, 0.25, ("tilt", -60.0)),
    toon(0.05, 0.6, ("tilt", -30.0)),
    toon(0.3, 0.3, ("tilt", -30.0)),
    toon(0.5, 0.5, ("tilt", -30.0)),
    toon(0.01, 0.75),
    toon(0.3, 0.6),
    toon(0.5, 0.5),
    toon(0.6, 0.3),
    toon(0.75, 0.25),
    toon(0.8, 0.1),
    toon(0.9, 0.1),
    toon(1.0, 0.0),
    toon_glossy(0.5, 0.35),
    translucent(),
    translucent("I"),
    translucent("N+I"),
    translucent(("tilt", 15.0)),
    through(0.02, 0.04),
    through(0.02, 0.06),
    through(0.035, 0.105),
    through(0.06, 0.072),
    through(0.06, 0.12),
    through(0.06, 0.18),
    through(0.1, 0.12),
    through(0.1, 0.2),
    through(0.1, 0.3),
    through(0.16, 0.32),
    through(0.4, 1.0),
    through(0.035, 0.105, lean=0.12),
    through(0.06, 0.18, lean=0.12),
    through(0.1, 0.3, lean=0.12),
    through(0.06, 0.18, lean=0.27),
    through(0.1, 0.3, lean=0.27),
    through(0.16, 0.5, lean=0.27),
    through(0.1, 0.3, lean=0.5),
    through(0.16, 0.5, lean=0.75),
    through(0.25, 1.0, lean=0.75),
    through(0.16, 0.5, lean=1.0),
)

_BY_ID = {lobe.id: lobe for lobe in DICTIONARY}

# Closures made for the boundaries of one stack. Their ids hold their parameters.
_MADE: dict[str, Callable[..., Lobe]] = {
    "toon": lambda lean, size, smooth: toon(size, smooth, ("lean", lean), name=f"toon:{lean:g}:{size:g}:{smooth:g}"),
    "retro": lambda size, smooth: toon(size, smooth, "I", name=f"retro:{size:g}:{smooth:g}"),
    "ggx": lambda alpha: ggx(math.sqrt(alpha), name=f"ggx:{alpha:g}"),
    "beckmann": lambda alpha: beckmann(math.sqrt(alpha), name=f"beckmann:{alpha:g}"),
    "fresnel_ggx": lambda ior, alpha: fresnel_ggx(ior, math.sqrt(alpha), name=f"fresnel_ggx:{ior:g}:{alpha:g}"),
    "halo": lambda alpha: halo(alpha, name=f"halo:{alpha:g}"),
    "moving": moving_lobes.lobe,
    "oriented": oriented_lobes.lobe,
    following_lobes.GGX: lambda scale, least: _following(
        following_lobes.ggx(scale, least), scale, least, {"Roughness": (1.0, 0.5)}),
    following_lobes.TOON: lambda scale, least, lean, size, smooth: _following(
        following_lobes.toon(scale, least, lean, size, smooth), scale, least,
        {"Size": (size, 1.0), "Smooth": (smooth, 1.0)}),
}


def _following(name: str, scale: float, least: float, of_width: dict) -> Lobe:
    """A closure that follows the roughness of the base, with the values that it has at the roughness 1/2."""
    lobe = by_id(following_lobes.at(name, 0.5))
    inputs = {socket: value for socket, value in lobe.node.inputs.items() if socket not in of_width}
    return replace(lobe, id=name, node=replace(lobe.node, inputs=inputs, width=(scale, least), of_width=of_width))


def by_id(lobe_id: str) -> Lobe:
    """The lobe with this id: one of the dictionary, or one made for a stack, such as "ggx:0.1" (alpha), "beckmann:0.1",
    "halo:0.1", "moving:0", "fresnel_ggx:1.5:0.1" (index, alpha), "toon:0.3:0.05:0.2" (lean, size, smooth),
    "retro:0.05:0.2" (size, smooth), or one of following_lobes. Raises UnknownName, a KeyError and StackError."""
    if not isinstance(lobe_id, str):
        raise _unknown(lobe_id)
    return _lobe_of(lobe_id)


@functools.lru_cache(maxsize=512)
def _lobe_of(lobe_id: str) -> Lobe:
    if lobe_id in _BY_ID:
        return _BY_ID[lobe_id]
    family, *numbers = lobe_id.split(":")
    try:
        values = [float(number) for number in numbers]
        lobe = _MADE[family](*values) if all(map(math.isfinite, values)) else None
    except (KeyError, TypeError, ValueError, ZeroDivisionError, OverflowError):
        lobe = None
    if lobe is None or lobe.id != lobe_id:
        raise _unknown(lobe_id)
    return lobe


def _unknown(closure) -> UnknownName:
    return UnknownName(f"closure = {quoted(closure)}: not in the dictionary")


def recipe(closure: str) -> NodeRecipe:
    """The node of a lobe, or of a closure for delta light: "transparent" for unscattered light, "mirror:ALPHA" for
    specular reflection by smooth boundaries. Raises UnknownName, a KeyError and StackError."""
    if not isinstance(closure, str):
        raise _unknown(closure)
    if closure == "transparent":
        return NodeRecipe("ShaderNodeBsdfTransparent", normal_input="")
    if closure.startswith("mirror:"):
        return mirror(math.sqrt(_mirror_alpha(closure)))
    return by_id(closure).node


def _mirror_alpha(closure: str) -> float:
    """The microfacet width in the id of a mirror. Raises UnknownName if there is none in [0, 1]."""
    try:
        alpha = float(closure.removeprefix("mirror:"))
    except ValueError:
        alpha = math.nan
    if not 0.0 <= alpha <= 1.0:
        raise _unknown(closure)
    return alpha


_gauss = functools.lru_cache(maxsize=4)(np.polynomial.legendre.leggauss)


def directional_albedo(lobe: Lobe, mu_o, nodes: tuple[int, int] = (96, 64)) -> np.ndarray:
    """Integral of `evaluate` over the light's hemisphere, shape of `mu_o`.

    `nodes`: numbers of nodes in theta (Gauss) and in dphi (midpoint). The default is accurate to 3e-4 for every closure
    of the dictionary; their kinks need more nodes than a scattering function. `mu_o`: cosines in (0, 1]. Raises
    ArgumentError.
    """
    check_kind(lobe, "lobe", Lobe, "a lamina.lobes.Lobe")
    x, w = _gauss(nodes[0])
    theta = (x + 1.0) * np.pi / 4
    dphi = (np.arange(nodes[1]) + 0.5) * np.pi / nodes[1]
    mu_o = finite_array(mu_o, "mu_o")
    cosines(mu_o, "mu_o")  # checks them
    value = lobe.evaluate(mu_o[..., None, None], np.cos(theta)[:, None], dphi)
    return (value.mean(axis=-1) * (w * np.sin(theta))).sum(axis=-1) * np.pi**2 / 2

# SPDX-License-Identifier: GPL-3.0-or-later
"""The Cycles closures that Lamina mixes: each with its closed form and its node recipe.

This is the one place where closures are defined.  A `Lobe` says what one closure of unit weight
reflects (or transmits), as the cosine-weighted value f * |cos theta_i| in 1/sr, and how to build it
out of shader nodes.  `tests/cycles/test_lobes.py` measures every one of them in Cycles, so that a
Blender release which changes a closure is noticed.

Conventions: `mu_o`, `mu_i` in (0, 1] are the cosines of viewer and light with the normal, `dphi` in
radians is 0 when the light keeps its azimuth (forward) and pi back towards the light.  The viewer is
at (sin theta_o, 0, cos theta_o), so the light is at (-sin theta_i cos dphi, -sin theta_i sin dphi,
+-cos theta_i): above the surface for a reflection lobe, below it for a transmission lobe.

Weights depend on the view only.  Normals may be tilted for Diffuse, Translucent and Toon closures
alone: Cycles 4.5 samples tilted microfacets wrongly.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

Normal = str | tuple[str, float]
Evaluate = Callable[..., np.ndarray]

GEOMETRIC = "N"
INCOMING = "I"


@dataclass(frozen=True)
class NodeRecipe:
    """How to build a closure out of one shader node; plain data, interpreted by the add-on.

    `weight_input` takes the linear RGB weight.  `inputs` are socket values by name, `enums` are node
    properties.  `normal` (fed into the socket `normal_input`) is "N", "I", "N+I", "N+R" (normalised
    sums; R mirrors I at N) or ("tilt", degrees): N turned towards the viewer, in the plane of
    incidence.  `vectors` are further sockets that take such a direction: a `normal` of "I" is the
    vector Geometry.Incoming.  `invert_ior_on_backface`: Cycles takes 1/IOR on back faces, so the
    graph has to feed it 1/IOR there for the same lobe on both sides.
    """

    type: str
    weight_input: str = "Color"
    inputs: Mapping[str, object] = field(default_factory=dict)
    enums: Mapping[str, str] = field(default_factory=dict)
    normal: Normal = GEOMETRIC
    normal_input: str = "Normal"
    vectors: Mapping[str, Normal] = field(default_factory=dict)
    invert_ior_on_backface: bool = False


@dataclass(frozen=True)
class Lobe:
    """One closure of unit weight: `evaluate(mu_o, mu_i, dphi)` -> f * |cos theta_i|, broadcast, 1/sr."""

    id: str
    side: str
    evaluate: Evaluate = field(repr=False, compare=False)
    node: NodeRecipe = field(repr=False, compare=False)


class _Geometry:
    """The two directions of a configuration in the frame whose z axis is the surface normal."""

    def __init__(self, mu_o, mu_i, dphi, below: bool = False):
        self.mu_o, self.mu_i, dphi = np.broadcast_arrays(*(np.asarray(x, float) for x in (mu_o, mu_i, dphi)))
        self.sin_o = np.sqrt(np.maximum(0.0, 1.0 - self.mu_o**2))
        self.sin_i = np.sqrt(np.maximum(0.0, 1.0 - self.mu_i**2))
        self.light_x = -self.sin_i * np.cos(dphi)
        self.light_y = -self.sin_i * np.sin(dphi)
        self.light_z = -self.mu_i if below else self.mu_i
        self.cos_between = self.sin_o * self.light_x + self.mu_o * self.light_z

    def cos_half(self):
        """Cosine between the half vector and either direction."""
        return np.sqrt(np.maximum(0.0, 0.5 * (1.0 + self.cos_between)))

    def along(self, normal: Normal):
        """Cosine of the light with a (possibly tilted) normal, which lies in the plane of incidence."""
        x, z = self.normal(normal)
        return x * self.light_x + z * self.light_z

    def normal(self, normal: Normal):
        """The (x, z) components of a named normal; see `NodeRecipe`."""
        if normal == "N":
            return np.zeros_like(self.mu_o), np.ones_like(self.mu_o)
        if normal == "I":
            return self.sin_o, self.mu_o
        if normal in ("N+I", "N+R"):
            half_cosine = np.sqrt(0.5 * (1.0 + self.mu_o))
            half_sine = np.sqrt(0.5 * (1.0 - self.mu_o))
            return (half_sine if normal == "N+I" else -half_sine), half_cosine
        if isinstance(normal, tuple) and normal[0] == "tilt":
            angle = np.radians(normal[1])
            return np.full_like(self.mu_o, np.sin(angle)), np.full_like(self.mu_o, np.cos(angle))
        raise ValueError(f"normal = {normal!r}: must be 'N', 'I', 'N+I', 'N+R' or ('tilt', degrees)")


def _number(x: float) -> str:
    return f"{x:g}".replace(".", "").replace("-", "m")


def _normal_suffix(normal: Normal) -> str:
    if isinstance(normal, tuple):
        return f"_tilt{_number(normal[1])}"
    return {"N": "", "I": "_i", "N+I": "_h", "N+R": "_r"}[normal]


# --- Lambert's cosine ---------------------------------------------------------------------------


def diffuse(normal: Normal = GEOMETRIC) -> Lobe:
    """Diffuse BSDF of roughness 0 about any normal: max(n.l, 0) / pi."""

    def evaluate(mu_o, mu_i, dphi):
        return np.maximum(_Geometry(mu_o, mu_i, dphi).along(normal), 0.0) / np.pi

    node = NodeRecipe("ShaderNodeBsdfDiffuse", inputs={"Roughness": 0.0}, normal=normal)
    return Lobe("diffuse" + _normal_suffix(normal), "reflection", evaluate, node)


def translucent(normal: Normal = GEOMETRIC) -> Lobe:
    """Translucent BSDF, the Lambert lobe of the far side: max(-n.l, 0) / pi."""

    def evaluate(mu_o, mu_i, dphi):
        return np.maximum(-_Geometry(mu_o, mu_i, dphi, below=True).along(normal), 0.0) / np.pi

    node = NodeRecipe("ShaderNodeBsdfTranslucent", normal=normal)
    return Lobe("translucent" + _normal_suffix(normal), "transmission", evaluate, node)


# --- GGX ----------------------------------------------------------------------------------------


def _smith_lambda(x, y, z, alpha_x, alpha_y):
    """Smith's Lambda of the GGX distribution for the direction (x, y, z)."""
    slope2 = ((alpha_x * x) ** 2 + (alpha_y * y) ** 2) / np.maximum(z * z, 1e-300)
    return 0.5 * (np.sqrt(1.0 + slope2) - 1.0)


def _ggx_reflection(g: _Geometry, alpha_x: float, alpha_y: float):
    """D G2 / (4 mu_o) with height-correlated Smith masking; x is the plane of incidence.

    For alpha_x = alpha_y = 1 this is mu_i / (2 pi (mu_o + mu_i)), the law of Lommel and Seeliger.
    """
    half_x, half_y, half_z = g.sin_o + g.light_x, g.light_y, g.mu_o + g.mu_i
    length2 = half_x**2 + half_y**2 + half_z**2
    stretched = (half_x / alpha_x) ** 2 + (half_y / alpha_y) ** 2 + half_z**2
    density = (length2 / stretched) ** 2 / (np.pi * alpha_x * alpha_y)
    masking = 1.0 + _smith_lambda(g.sin_o, 0.0, g.mu_o, alpha_x, alpha_y)
    masking = masking + _smith_lambda(g.light_x, g.light_y, g.mu_i, alpha_x, alpha_y)
    return density / (4.0 * g.mu_o * masking)


def ggx(roughness: float, anisotropy: float = 0.0) -> Lobe:
    """Glossy BSDF, distribution GGX (never Multiscatter), without Fresnel.

    Positive `anisotropy` makes it narrow in the plane of incidence and wide across it: the tangent is
    the incoming direction, so the lobe turns with the viewer.
    """
    alpha = roughness**2
    squeeze = 1.0 - abs(anisotropy)
    narrow, wide = alpha * squeeze, min(1.0, alpha / squeeze)  # Cycles clamps alpha to 1
    alpha_x, alpha_y = (narrow, wide) if anisotropy > 0 else (wide, narrow)

    def evaluate(mu_o, mu_i, dphi):
        return _ggx_reflection(_Geometry(mu_o, mu_i, dphi), alpha_x, alpha_y)

    name = f"ggx_{_number(roughness)}" + (f"_a{_number(anisotropy)}" if anisotropy else "")
    node = NodeRecipe(
        "ShaderNodeBsdfAnisotropic",
        inputs={"Roughness": roughness, "Anisotropy": anisotropy, "Rotation": 0.0},
        enums={"distribution": "GGX"},
        vectors={"Tangent": INCOMING} if anisotropy else {},
    )
    return Lobe(name, "reflection", evaluate, node)


def _fresnel(cosine, ior: float):
    """Unpolarised reflectance of a dielectric of relative index `ior`; 1 beyond the critical angle."""
    refracted2 = ior * ior - 1.0 + cosine**2
    g = np.sqrt(np.maximum(refracted2, 0.0))
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return np.where(refracted2 > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)


def fresnel_ggx(ior: float, roughness: float = 1.0) -> Lobe:
    """P(n): GGX times (F - F0) / (1 - F0), a Lommel-Seeliger lobe with a forward phase function.

    F depends on half the scattering angle alone.  The node is a Principled BSDF with everything but
    its specular layer black; the tint of a coat of index 1, seen along its own normal, is a linear
    weight without an upper limit.
    """
    alpha = roughness**2
    normal_reflectance = ((ior - 1.0) / (ior + 1.0)) ** 2

    def evaluate(mu_o, mu_i, dphi):
        g = _Geometry(mu_o, mu_i, dphi)
        fresnel = (_fresnel(g.cos_half(), ior) - normal_reflectance) / (1.0 - normal_reflectance)
        return np.maximum(fresnel, 0.0) * _ggx_reflection(g, alpha, alpha)

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
    name = f"p{_number(ior)}" + (f"_{_number(roughness)}" if roughness != 1.0 else "")
    return Lobe(name, "reflection", evaluate, node)


# --- Toon ---------------------------------------------------------------------------------------


def _toon(cosine, size: float, smooth: float):
    """A cone of half-angle `size`, then a linear ramp of width `smooth` (both over pi/2)."""
    inner, ramp = max(size, 1e-5) * np.pi / 2, smooth * np.pi / 2
    beyond = np.arccos(np.clip(cosine, 0.0, 1.0)) - inner
    intensity = np.where(beyond < 0.0, 1.0, np.clip(1.0 - beyond / ramp, 0.0, 1.0) if ramp > 0.0 else 0.0)
    solid_angle = 2.0 * np.pi * (1.0 - np.cos(min(inner + ramp, np.pi / 2)))
    return np.where(cosine >= 0.0, intensity / solid_angle, 0.0)


def toon(size: float, smooth: float, normal: Normal = GEOMETRIC) -> Lobe:
    """Toon BSDF, component Diffuse: a soft cone about a normal, whatever the viewer does."""

    def evaluate(mu_o, mu_i, dphi):
        return _toon(_Geometry(mu_o, mu_i, dphi).along(normal), size, smooth)

    node = NodeRecipe(
        "ShaderNodeBsdfToon", inputs={"Size": size, "Smooth": smooth}, enums={"component": "DIFFUSE"},
        normal=normal,
    )
    name = f"toon_{_number(size)}_{_number(smooth)}" + _normal_suffix(normal)
    return Lobe(name, "reflection", evaluate, node)


def toon_glossy(size: float, smooth: float) -> Lobe:
    """Toon BSDF, component Glossy: a soft cone about the mirror direction."""

    def evaluate(mu_o, mu_i, dphi):
        g = _Geometry(mu_o, mu_i, dphi)
        return _toon(g.mu_o * g.mu_i - g.sin_o * g.light_x, size, smooth)

    node = NodeRecipe(
        "ShaderNodeBsdfToon", inputs={"Size": size, "Smooth": smooth}, enums={"component": "GLOSSY"}
    )
    return Lobe(f"toonglossy_{_number(size)}_{_number(smooth)}", "reflection", evaluate, node)


# --- Sheen --------------------------------------------------------------------------------------


def sheen_ashikhmin(sigma: float) -> Lobe:
    """Sheen BSDF, distribution Ashikhmin: an inverted Gaussian of half vectors with a V-groove."""

    def evaluate(mu_o, mu_i, dphi):
        g = _Geometry(mu_o, mu_i, dphi)
        cos_between = np.maximum(g.cos_half(), 1e-5)
        cos_half2 = ((g.mu_o + g.mu_i) / (2.0 * cos_between)) ** 2
        sin_half2 = np.maximum(1.0 - cos_half2, 1e-12)
        density = np.exp(-cos_half2 / sin_half2 / sigma**2) / (np.pi * sigma**2 * sin_half2**2)
        groove = 2.0 * np.sqrt(cos_half2) / cos_between * np.minimum(g.mu_o, g.mu_i)
        return 0.25 * density * np.minimum(1.0, groove) / g.mu_o

    node = NodeRecipe(
        "ShaderNodeBsdfSheen", inputs={"Roughness": sigma}, enums={"distribution": "ASHIKHMIN"}
    )
    return Lobe(f"sheen_a_{_number(sigma)}", "reflection", evaluate, node)


# --- The dictionary -----------------------------------------------------------------------------

# Found by backward elimination from 360 closures on random slabs (g from -.5 to .88, with and without a
# Lambertian base): the loss against all of them is .1 points of error at six closures a material.
# Refraction BSDFs are left out on purpose: under a lamp Cycles evaluates them for half vectors that it
# never samples, so that a rough one loses up to half of its light under a sky.
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
    translucent(("tilt", -75.0)),
    translucent(("tilt", 15.0)),
    translucent(("tilt", 60.0)),
    translucent(("tilt", 85.0)),
)

_BY_ID = {lobe.id: lobe for lobe in DICTIONARY}


def by_id(lobe_id: str) -> Lobe:
    """The lobe of that id; KeyError with the id when there is none."""
    if lobe_id not in _BY_ID:
        raise KeyError(f"closure {lobe_id!r}: not in the dictionary")
    return _BY_ID[lobe_id]


def directional_albedo(lobe: Lobe, mu_o, nodes: tuple[int, int] = (96, 64)) -> np.ndarray:
    """Integral of `evaluate` over the light's hemisphere, shape of `mu_o`.

    `nodes` are those in theta (Gauss) and dphi (midpoint); the default is good to 3e-4 for every closure
    of the dictionary, whose kinks need more nodes than a scattering function does.
    """
    x, w = np.polynomial.legendre.leggauss(nodes[0])
    theta = (x + 1.0) * np.pi / 4
    dphi = (np.arange(nodes[1]) + 0.5) * np.pi / nodes[1]
    mu_o = np.asarray(mu_o, float)
    value = lobe.evaluate(mu_o[..., None, None], np.cos(theta)[:, None], dphi)
    return (value.mean(axis=-1) * (w * np.sin(theta))).sum(axis=-1) * np.pi**2 / 2

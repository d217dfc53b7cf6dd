# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of an interior: end materials, marble, the surface, voxels, and the maps of its light.

The panel's defaults must never change after a release: .blend files do not store unchanged values."""

from __future__ import annotations

from .fields import Field
from .limits import MOST_NODE_IOR, MOST_SEED, MOST_TEXELS, SEED
from .panel import Panel

MOST_COEFFICIENT = 65504.0  # 1/mm, the largest half


def _end(sigma_s: tuple[float, float, float], sigma_a: tuple[float, float, float]) -> tuple[Field, Field, Field]:
    """The fields of an end material with these defaults."""
    return (_coefficient("sigma_s", "Scattering", sigma_s), _coefficient("sigma_a", "Absorption", sigma_a),
            Field("g", -0.999, 0.999, panel=Panel(
                "Anisotropy", "Mean cosine of the scattering angle; above 0 scatters forwards", 0.0)))


def _coefficient(name: str, label: str, default: tuple[float, float, float]) -> Field:
    return Field(name, 0.0, MOST_COEFFICIENT, unit="1/mm", panel=Panel(
        f"{label} (1/mm)", f"{label} coefficient of red, green and blue, per mm", default, soft_high=10.0, step=1,
        precision=4, rgb=True))


# White marble: Jensen, Marschner, Levoy and Hanrahan 2001, measured; reduced scattering, so that g is 0. The veins'
# coefficients are chosen, not measured.
GROUND = _end((2.19, 2.62, 3.00), (0.0021, 0.0041, 0.0071))
VEINS = _end((1.7, 1.9, 2.1), (0.06, 0.06, 0.055))
SIGMA_S, SIGMA_A, G = GROUND  # their names and ranges, which VEINS shares


def _length(name: str, label: str, tip: str, default: float) -> Field:
    return Field(name, 1e-6, 1e6, unit="mm", panel=Panel(
        f"{label} (mm)", tip, default, low=1e-3, soft_high=100.0, precision=3))


# In the panel's order.
MARBLE = (
    _length("spacing", "Spacing", "Distance between veins before they are distorted, in mm", 12.0),
    Field("width", 1e-3, 1.0, panel=Panel("Width", "Width of veins, relative to their spacing", 0.25)),
    Field("distortion", 0.0, 100.0, panel=Panel(
        "Distortion", "Displacement of the veins by turbulence, relative to their spacing", 3.0, soft_high=10.0)),
    _length("feature", "Feature Size", "Size of the largest distortions, in mm", 20.0),
    Field("octaves", 1, 12, whole=True, panel=Panel("Detail", "Number of octaves of the turbulence", 6)),
    Field("lacunarity", 1.0, 8.0),
    Field("gain", 0.0, 1.0),
    Field("seed", 0, MOST_SEED, whole=True, rule=SEED, panel=Panel("Seed", "Seed of the veins", 0, high=(1 << 31) - 1)),
)
DIRECTION = (0.5, 0.3, 0.8)  # normal of the planes of veins

IOR = Field("ior", 1.0, MOST_NODE_IOR, panel=Panel(
    "IOR", "Index of refraction of the object's surface; 1 is no boundary", 1.5))
ROUGHNESS = Field("roughness", 0.0, 1.0, panel=Panel(
    "Roughness", "Roughness of the object's surface; 0 is polished", 0.3, subtype="FACTOR"))
VOXELS = Field("voxels", 1, 1024, whole=True, panel=Panel(
    "Voxels", "Number of voxels along the longest side of the object", 128, high=512, prop="resolution"))
BODY = (IOR, ROUGHNESS, VOXELS)

SIZE = Field("size", 1, MOST_TEXELS, whole=True, panel=Panel(
    "Size", "Width and height of the images in texels", 128, low=4, high=8192))
NOISE = Field("noise", 0.0, 1.0, above=True, panel=Panel(
    "Noise", "Standard error of a texel in percent of the mean, before smoothing. Half the noise takes four times as "
    "long", 0.08, low=1e-4, soft_low=0.005, soft_high=0.2, precision=1, subtype="PERCENTAGE", percent=True))
MAPS = (SIZE, NOISE)


def defaults(fields) -> dict:
    """{name: default} of the fields that the panel shows."""
    return {field.name: field.panel.default for field in fields if field.panel is not None}

# SPDX-License-Identifier: GPL-3.0-or-later
"""Mitsuba 3 as an oracle: exported files read by its plugin `measured`."""

from __future__ import annotations

import math

import mitsuba as mi
import numpy as np


def measured(path, variant: str = "scalar_rgb"):
    """A .bsdf file as Mitsuba's BSDF, in one of its scalar variants."""
    mi.set_variant(variant)
    return mi.load_dict({"type": "measured", "filename": str(path)})


def evaluate(bsdf, mu_o, mu_i, dphi, wavelengths=None) -> np.ndarray:
    """f cos(theta_o), [direction, channel], at cosines and azimuths of light's travel as in S.brdf. The frame
    is turned by an odd angle: the surface has no direction of its own."""
    at = mi.SurfaceInteraction3f()
    if wavelengths is not None:
        at.wavelengths = wavelengths
    context = mi.BSDFContext()
    values = []
    for cos_o, cos_i, azimuth in zip(mu_o, mu_i, dphi, strict=True):
        at.wi = direction(cos_i, 1.234 + math.pi)
        values.append(bsdf.eval(context, at, direction(cos_o, 1.234 + azimuth)))
    return np.array(values)


def furnace(bsdf, mu_i: float, samples: int, seed: int) -> tuple[np.ndarray, np.ndarray, float]:
    """(mean, standard error) by channel of the weights that the BSDF's own sampling returns for light at
    cosine mu_i, which is the directional albedo, and how far its pdf is off at the samples, relatively."""
    random = np.random.default_rng(seed)
    at = mi.SurfaceInteraction3f()
    at.wi = direction(mu_i, 0.5)
    context = mi.BSDFContext()
    weights, worst = [], 0.0
    for sample in random.uniform(size=(samples, 2)):
        drawn, weight = bsdf.sample(context, at, 0.5, mi.Point2f(sample))
        weights.append(weight)
        if drawn.wo.z > 0.01:
            worst = max(worst, abs(bsdf.pdf(context, at, drawn.wo) / drawn.pdf - 1.0))
    weights = np.array(weights)
    return weights.mean(axis=0), weights.std(axis=0) / math.sqrt(samples), worst


def direction(cosine: float, azimuth: float):
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    return mi.Vector3f(sine * math.cos(azimuth), sine * math.sin(azimuth), cosine)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Mitsuba 3 as an oracle: exported files read by its plugin `measured`, and stacks as slabs of surfaces and
media for its path tracer `volpath`."""

from __future__ import annotations

import math

import mitsuba as mi
import numpy as np

import lamina
from lamina.kinds.fields import channel


def measured(path, variant: str = "scalar_rgb"):
    """A .bsdf file as Mitsuba's BSDF, in one of its scalar variants."""
    mi.set_variant(variant)
    return mi.load_dict({"type": "measured", "filename": str(path)})


def evaluate(bsdf, mu_o, mu_i, dphi, wavelengths=None) -> np.ndarray:
    """f cos(theta_o), [direction, channel], at cosines and azimuths of light's travel as in S.brdf. The frame is turned
    by an arbitrary angle: the surface has no preferred direction."""
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


# Media are this thick, in the scene's units: Mitsuba's rays start about 1e-4 of their place's distance from the
# origin beside a surface, so that optical thicknesses are right to some 1e-4.
THICKNESS = 10.0
# Half the width of all surfaces: the share of light that leaves through the edges is below (THICKNESS / WIDTH)^2.
WIDTH = 1e5


def slab(stack: lamina.Stack, index: int = 0, visible: bool = True) -> tuple[dict, float]:
    """(shapes, z of the lowest) of one channel of a stack, its top at z = 0: huge rectangles between
    homogeneous media. Takes Henyey-Greenstein and isotropic phase functions. `visible`: sample the facets that
    a ray sees, else all of them; the answer is the same."""
    shapes: dict = {}
    above, ior, z = None, 1.0, 0.0
    surface = {"type": "null"}
    for number, layer in enumerate(stack.layers):
        if isinstance(layer, lamina.Interface):
            below = channel(layer.ior, index)
            surface, ior = _dielectric(layer, ior, below, index, visible), below
            clear = number + 1 == len(stack.layers) or isinstance(stack.layers[number + 1], lamina.Interface)
            if not clear:
                continue
            medium = None
        else:
            medium = _medium(*stack.optics(number, index), layer.phase)
        shapes[f"surface{number}"] = _plane(z, surface, above, medium)
        above, surface = medium, {"type": "null"}
        z -= THICKNESS
    if stack.base is not None:
        shapes["base"] = _plane(z, _base(stack.base, ior, index, visible), above, None)
    elif above is not None:
        shapes["bottom"] = _plane(z, surface, above, None)
    return shapes, z


def _plane(z: float, bsdf: dict, above, below) -> dict:
    place = mi.ScalarTransform4f().translate([0.0, 0.0, z]).scale(WIDTH)
    plane = {"type": "rectangle", "to_world": place, "bsdf": bsdf}
    if above is not None:
        plane["exterior"] = above
    if below is not None:
        plane["interior"] = below
    return plane


def _medium(albedo: float, tau: float, phase):
    g = getattr(phase, "g", 0.0)
    return mi.load_dict({"type": "homogeneous", "albedo": albedo, "sigma_t": tau / THICKNESS,
                         "phase": {"type": "hg", "g": g} if g else {"type": "isotropic"}})


def _facets(surface, index: int, visible: bool) -> dict:
    alpha = channel(surface.alpha, index)
    # Mitsuba's facets scatter once and mask both directions independently.
    assert alpha == 0.0 or not (surface.correlated or surface.compensate)
    if alpha == 0.0:
        return {}
    return {"distribution": surface.distribution, "alpha": alpha, "sample_visible": visible}


def _dielectric(layer, above: float, below: float, index: int, visible: bool) -> dict:
    if above == below:
        return {"type": "null"}
    facets = _facets(layer, index, visible)
    return {"type": "roughdielectric" if facets else "dielectric", "int_ior": below, "ext_ior": above, **facets}


def _base(base, ior: float, index: int, visible: bool) -> dict:
    if isinstance(base, lamina.Conductor):
        facets = _facets(base, index, visible)
        # Mitsuba's index of a metal is relative to the medium above.
        return {"type": "roughconductor" if facets else "conductor", "eta": channel(base.eta, index) / ior,
                "k": channel(base.k, index) / ior, **facets}
    return {"type": "diffuse", "reflectance": {"type": "rgb", "value": channel(base.reflectance, index)}}


def estimate(stack: lamina.Stack, mu_o: float, quantity: str, samples: int, seed: int,
             mu_i: float | None = None, dphi: float = 0.0, visible: bool = True) -> tuple[float, float]:
    """(mean, standard error) of "reflectance" or "transmittance" for light at mu_o, by Mitsuba's volpath: the radiance
    at mu_o under unit radiance from the whole side, which is equal by reciprocity. "brdf" uses a single light at mu_i,
    which specular paths cannot hit, so the mirror image is left out.

    Each of 32^2 pixels is an independent estimate."""
    mi.set_variant("scalar_rgb")
    shapes, bottom = slab(stack, visible=visible)
    black = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}}
    if quantity == "brdf":
        # Light travels with azimuth 0; the camera sees light that leaves at dphi.
        light = {"type": "directional", "irradiance": {"type": "rgb", "value": 1.0 / mu_i},
                 "direction": -direction(mu_i, math.pi)}
        lid: dict = {}
    else:
        light = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}
        # A screen hides the other half of the light. The camera stands below an upper lid.
        z = bottom - 1.0 if quantity == "reflectance" else 10.0
        lid = {"lid": {**_plane(z, black, None, None)}}
    towards = direction(mu_o, dphi)
    place = mi.ScalarTransform4f().look_at(origin=mi.Point3f(towards * 5.0), target=mi.Point3f(0.0),
                                           up=[0.6, 0.8, 0.1])
    scene = mi.load_dict({
        "type": "scene", **shapes, **lid, "light": light,
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 100},
        "sensor": {"type": "orthographic", "to_world": place @ mi.ScalarTransform4f().scale(0.01),
                   "film": {"type": "hdrfilm", "width": 32, "height": 32, "rfilter": {"type": "box"},
                            "pixel_format": "luminance"},
                   "sampler": {"type": "independent"}},
    })
    image = np.array(mi.render(scene, spp=-(-samples // 1024), seed=seed), dtype=float).ravel()
    return image.mean(), image.std(ddof=1) / math.sqrt(image.size)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Principled materials under layers: the baked group in Cycles, at values of its sockets, against lamina.solve of the
same stack."""

from dataclasses import dataclass, replace
from functools import cached_property

import baked_samples
import goniophotometer
import numpy as np

import lamina
from lamina import Medium, PrincipledBase, Stack

SOCKETS = {"color": "Base Color", "metallic": "Metallic", "roughness": "Roughness"}


@dataclass(frozen=True)
class Shown:
    """A copy of a baked material at values of its sockets. `base`, `tau`: the values."""

    name: str
    material: object
    base: PrincipledBase
    stack: Stack

    @cached_property
    def exact(self) -> lamina.ScatteringFunction:
        return lamina.solve(self.stack)


def baked(addon, name, layers, base: PrincipledBase, quality):
    """(material, lut) of layers over the base, made as a user does."""
    sample = baked_samples.make_sample(addon, name, Stack(layers, base), baked_samples.gauss_views(3), quality)
    return sample.material, sample.lut


def at(material, lut, dust: Medium, base: PrincipledBase, tau: float, **values) -> Shown:
    """The material below dust of this thickness, at `values` of the inputs, by their names in PrincipledBase."""
    return below(material, lut, [dust], base, tau, **values)


def below(material, lut, layers, base: PrincipledBase, tau: float | None = None, **values) -> Shown:
    """The material at `values` of the inputs, by their names in PrincipledBase, and at a thickness of the layer that
    varies, if one does."""
    values = {**{name: getattr(base, name) for name in base.inputs}, **values}
    copy = material.copy()
    node = baked_samples.group_node(copy, lut)
    if tau is not None:
        node.inputs["Thickness"].default_value = tau
    for name, value in values.items():
        node.inputs[SOCKETS[name]].default_value = (*value, 1.0) if name == "color" else value
    shown = replace(base, inputs=(), **values)
    stack = Stack([replace(one, tau=tau, varying=False) if getattr(one, "varying", False) else one for one in layers],
                  shown)
    words = "".join(f", {name} {value}" for name, value in values.items())
    thickness = "" if tau is None else f", tau {tau:g}"
    return Shown(f"{material.name}{thickness}{words}", copy, shown, stack)


def slice_errors(shown, views, lights):
    """Relative L2 errors over these lights [sample, view, channel]."""
    mu = views.mu[:, None]
    seen = np.array([[goniophotometer.measure_many([one.material for one in shown], float(view), *light, samples=1)
                      for light in zip(*np.broadcast_arrays(lights.mu[v], lights.dphi[v]), strict=True)]
                     for v, view in enumerate(views.mu)])  # [view, light, sample, channel]
    errors = []
    for k, one in enumerate(shown):
        exact = one.exact.brdf(mu, lights.mu, lights.dphi) * lights.mu[..., None]
        exact = np.broadcast_to(exact, seen[:, :, k].shape)
        errors.append(np.sqrt(lights.norm2(seen[:, :, k] - exact) / lights.norm2(exact)))
    return np.array(errors)


def albedo_errors(shown, mu_o, samples=1024):
    """Relative errors of the directional albedo under a white sky [sample, view]."""
    found = []
    for mu in mu_o:
        seen = goniophotometer.furnace_many([one.material for one in shown], mu, samples=samples)
        exact = np.array([np.broadcast_to(one.exact.reflectance(mu), 3) for one in shown])
        found.append(np.abs(seen / exact - 1.0).max(axis=1))
    return np.array(found).T

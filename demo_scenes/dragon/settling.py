# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles on Blender objects, as the attribute that the material reads."""

import numpy as np

ATTRIBUTE = "lamina_dust"


def settle_on(thing, amount, occluders=()):
    """Let dust of the optical thickness `amount` (on an open plate) settle; returns its statistics as plain data.

    The object's mesh gets the float attribute ATTRIBUTE of its vertices. occluders: objects that keep dust off."""
    mesh = thing.data
    normals = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertex_normals.foreach_get("vector", normals)
    tau = amount * np.maximum(normals.reshape(-1, 3)[:, 2], 0.0)
    write(mesh, tau)
    return {"mean": float(tau.mean()), "maximum": float(tau.max()), "covered": float(np.mean(tau > 0.01 * amount))}


def write(mesh, tau):
    """tau: (vertices,) optical thickness."""
    attribute = mesh.attributes.get(ATTRIBUTE) or mesh.attributes.new(ATTRIBUTE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.ascontiguousarray(tau, np.float32))

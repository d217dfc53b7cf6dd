# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles on Blender objects, as the attribute that the material reads."""

import dataclasses
import math

import numpy as np

SEED = 1
# Fine grains in the air of a room, which stay on slopes that are too steep for sand.
HOW = {"spread": 1.0, "repose": 1.25, "repose_width": 0.7, "concavity": 0.6}


def settle_on(thing, amount, occluders=(), rays=64):
    """Let dust of the optical thickness `amount` (on an open plate) settle; returns its statistics as plain data.

    The object's mesh gets the float attribute dust.ATTRIBUTE of its vertices. occluders: objects that keep dust off;
    rays: per vertex. Raises DustError, and DustUnavailable without a working Embree layer."""
    from lamina import dust  # the extension's wheel: not there before the extension is installed

    settings = dust.Settling(amount=float(amount), rays=rays, **HOW)
    settled = dust.settle(_mesh(dust, thing), occluders=[_mesh(dust, other) for other in occluders], settings=settings,
                          seed=SEED)
    write(thing.data, settled.tau)
    return {**dataclasses.asdict(settled.statistics), **HOW}


def write(mesh, tau):
    """tau: (vertices,) optical thickness."""
    from lamina import dust

    attribute = mesh.attributes.get(dust.ATTRIBUTE) or mesh.attributes.new(dust.ATTRIBUTE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.ascontiguousarray(tau, np.float32))


def _mesh(dust, thing):
    """The object's triangles in world space, without its modifiers."""
    mesh = thing.data
    mesh.calc_loop_triangles()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    turn = np.array(thing.matrix_world, float)
    # All faces are smooth, with one normal per vertex.
    return dust.Mesh(points.reshape(-1, 3) @ turn[:3, :3].T + turn[:3, 3], triangles.reshape(-1, 3),
                     sharp_angle=math.pi, name=thing.name)

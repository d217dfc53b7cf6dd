# SPDX-License-Identifier: GPL-3.0-or-later
"""A sphere and a step block, and thin shells of constant thickness around them.

Each shape is a function of an offset, by which its vertices are moved out, with the same faces. A shell between two
offsets therefore has the same thickness everywhere, except at edges.
"""

import math

import bpy
import numpy as np

RADIUS = 1.0
SPHERE_AT = (-1.25, 0.1, 1.05)
SEGMENTS, RINGS = 192, 96
# Profile of the steps in (x, z), counter-clockwise as seen from -y, and their extent along y.
STEPS = [(0.0, 0.05), (2.2, 0.05), (2.2, 1.7), (1.5, 1.7), (1.5, 1.15), (0.75, 1.15), (0.75, 0.6), (0.0, 0.6)]
STEPS_Y = (-0.9, 0.9)
STEPS_AT = (0.15, 0.1, 0.0)


def sphere(offset):
    """(vertices, faces) of the sphere with its radius grown by `offset`."""
    rows = [(0.0, 0.0, 1.0)]
    for ring in range(1, RINGS):
        theta = math.pi * ring / RINGS
        for segment in range(SEGMENTS):
            phi = 2.0 * math.pi * segment / SEGMENTS
            rows.append((math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)))
    rows.append((0.0, 0.0, -1.0))
    last = len(rows) - 1
    faces = []
    for segment in range(SEGMENTS):
        following = (segment + 1) % SEGMENTS
        faces.append((0, 1 + segment, 1 + following))
        base = last - SEGMENTS
        faces.append((last, base + following, base + segment))
        for ring in range(RINGS - 2):
            upper, lower = 1 + ring * SEGMENTS, 1 + (ring + 1) * SEGMENTS
            faces.append((upper + segment, lower + segment, lower + following, upper + following))
    return np.array(SPHERE_AT) + (RADIUS + offset) * np.array(rows), faces


def steps(offset):
    """(vertices, faces) of the step block with every face moved out by `offset`."""
    profile = _grown(np.array(STEPS), offset)
    count = len(profile)
    near, far = STEPS_Y[0] - offset, STEPS_Y[1] + offset
    corners = [(x, y, z) for y in (near, far) for x, z in profile]
    faces = [tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1))]
    faces += [(k, k + count, (k + 1) % count + count, (k + 1) % count) for k in range(count)]
    return np.array(STEPS_AT) + np.array(corners), faces


def _grown(profile, offset):
    """A counter-clockwise polygon of right angles with its edges moved outwards."""
    edges = np.roll(profile, -1, axis=0) - profile
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1)[:, None]
    # At a right angle the moved corner is the corner plus the shifts of both edges.
    return profile + offset * (normals + np.roll(normals, 1, axis=0))


SHAPES = {"sphere": sphere, "steps": steps}


def surface(scene, name, offset, material):
    """The shape `name` as a closed surface."""
    return _object(scene, name, *SHAPES[name](offset), material)


def shell(scene, name, inner, outer, material):
    """The volume between two offsets of the shape `name`, as one closed hollow mesh."""
    inside, faces = SHAPES[name](inner)
    outside, _ = SHAPES[name](outer)
    hollow = [tuple(len(outside) + k for k in reversed(face)) for face in faces]
    return _object(scene, f"{name} shell", np.concatenate([outside, inside]), [*faces, *hollow], material)


def _object(scene, name, corners, faces, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners.tolist(), [], faces)
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(thing)
    return thing

# SPDX-License-Identifier: GPL-3.0-or-later
"""What fills an object: lamina.Interior and lamina.Surface from the properties of a material."""

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base import native
from ..base.decimals import shortest
from ..base.messages import RefusedError
from ..editing import stack_io
from ..kinds import interiors
from ..properties.described import quantity
from . import node_texture
from .body import with_material
from .node_sources import default_source


@dataclass(frozen=True)
class Contents:
    """`fill`: a function of (progress, cancel) that returns the lamina.Interior and may run in a thread.
    `surface`: the lamina.Surface. `identity`: a text that is equal for equal interiors."""

    fill: Callable
    surface: object
    identity: str


def of_material(obj, material, body, source=None):
    """The Contents of a Body; `source`: by default that of the panel. Main thread only: it renders node
    textures. Raises RefusedError, lamina.InteriorError, lamina.StackError."""
    lamina, settings = native.require(), material.lamina.interior
    source = source or settings.source
    _check(obj, material, body)
    if source == "LAYERS":
        return _known(*_of_layers(lamina, material))
    surface = lamina.Surface(quantity(settings, interiors.IOR), quantity(settings, interiors.ROUGHNESS) ** 2)
    ends = ((settings.first, interiors.GROUND), (settings.second, interiors.VEINS))
    palette = [lamina.EndMaterial(**_numbers(end, fields)) for end, fields in ends]
    resolution = quantity(settings, interiors.VOXELS)
    low, high, counts = _box(body.arrays.vertices, resolution)
    if source == "NODES":
        corners = (low / body.millimetres, high / body.millimetres)
        values = node_texture.sample_nodes(obj, material, *corners, counts, texture(material))
        coordinate = np.clip(values.mean(axis=3), 0.0, 1.0)
        return _known(lamina.Interior.mixed(coordinate, palette, low, high), surface)
    direction = tuple(map(shortest, settings.direction))
    veins = lamina.Marble(palette, direction=direction, **_numbers(settings, interiors.MARBLE))

    def fill(progress, cancel):
        return lamina.marble(low, high, resolution, veins, progress, cancel)

    identity = json.dumps([veins.to_json(), low.tolist(), high.tolist(), resolution])
    return Contents(fill, surface, identity)


def _check(obj, material, body):
    """Raises RefusedError for coordinates that are not numbers, and for a material without faces."""
    wrong = np.flatnonzero(~np.isfinite(body.arrays.vertices).all(axis=1))
    if len(wrong):
        what = f"vertex {wrong[0]} of {obj.name} has a coordinate that is not a number"
        raise RefusedError(f"{what}: delete the vertex, or move it")
    # Modifiers can change materials: those of the mesh count only if the map has no area either.
    uvs = body.arrays.uvs
    has_area = body.own.any() if uvs is None else (uvs != uvs[:, :1]).any()
    if not has_area and not with_material(obj.data.polygons, obj, material).any():
        what = f"no face of {obj.name} has the material {material.name}"
        raise RefusedError(f"{what}: assign it to faces (Edit Mode > Assign), or select another slot")


def _of_layers(lamina, material):
    """(interior, surface) of the material's layers. Raises RefusedError, lamina.StackError."""
    try:
        return lamina.interior_of_stack(stack_io.to_stack(material))
    except lamina.StackError:
        if not len(material.lamina.layers):
            what = f"{material.name} has no Lamina layers"
            raise RefusedError(f"{what}: add one homogeneous medium, or choose another source") from None
        raise


def too_coarse(context, obj, settings):
    """A sentence if the voxels of a marble are wider than its veins, or ''."""
    side = max(obj.dimensions) * context.scene.unit_settings.scale_length * 1000.0
    voxel, vein = side / settings.resolution, settings.width * settings.spacing
    if settings.source != "MARBLE" or voxel <= vein:
        return ""
    return (
        f"The object is {side:.3g} mm large, so voxels are {voxel:.2g} mm wide and veins {vein:.2g} mm: "
        "scale the object down, or raise Spacing and Feature Size"
    )


def _numbers(owner, fields):
    """{name: value} of the fields that the panel shows."""
    return {field.name: quantity(owner, field) for field in fields if field.panel is not None}


def _known(interior, surface):
    return Contents(lambda _progress, _cancel: interior, surface, interior.hash)


def fill(end, preset):
    """Set an end material to the one medium of a preset of the library. Raises lamina.StackError."""
    lamina = native.require()
    stack = lamina.presets.load(preset)
    material = lamina.interior_of_stack(stack)[0].palette[0]
    end.sigma_s, end.sigma_a, end.g, end.preset = (
        material.sigma_s,
        material.sigma_a,
        material.g,
        stack.name or preset,
    )


def presets():
    """(id, name) of the presets that can be end materials, by name. Raises NativeMissingError."""
    lamina, found = native.require(), []
    for entry in lamina.presets.entries():
        try:
            lamina.interior_of_stack(entry.stack)
        except (lamina.StackError, lamina.InteriorError):
            continue
        found.append((entry.id, entry.name or entry.id))
    return sorted(found, key=lambda one: one[1].casefold())


def texture(material):
    """(node, output) of the texture that mixes the end materials. Raises RefusedError."""
    settings = material.lamina.interior
    if not settings.node:
        return default_source(material)
    node = material.node_tree.nodes.get(settings.node) if material.node_tree is not None else None
    first = node.outputs[0].identifier if node is not None and node.outputs else ""
    return settings.node, settings.socket or first


def _box(vertices, resolution):
    """(low, high) in mm, and the number of voxels along each axis; voxels are nearly cubes."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    side = float((high - low).max())
    if not side > 0.0:
        raise RefusedError("the object is 0 mm large: must have an extent")
    flat = 1e-6 * side  # the box must have an extent along each axis
    low, high = low - flat, high + flat
    counts = np.maximum(1, np.ceil(resolution * (high - low) / (high - low).max() - 1e-9)).astype(int)
    return low, high, tuple(map(int, counts))

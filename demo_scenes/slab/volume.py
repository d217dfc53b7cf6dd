# SPDX-License-Identifier: GPL-3.0-or-later
"""A layer stack as real geometry: boxes of Cycles volume over the stack's base.

Every medium becomes a separate box, THICKNESS high, with Volume Scatter and Volume Absorption. Light and view are the
same everywhere, so only tau = density * THICKNESS matters. The vacuum of GAP between boxes (coplanar faces would be
undefined) has no effect.
"""

import bpy
import node_tree

THICKNESS = 1.0
GAP = 0.001
CHANNELS = 3


def build(scene, stack, half_width):
    """Add the stack (a dict as in stack.json) to `scene`, its top face at z = 0. Returns the objects.

    Boxes and base are squares of 2 `half_width`. Raises ValueError for stacks that Cycles' volumes cannot represent.
    """
    objects = []
    top = 0.0
    for index, layer in enumerate(stack["layers"]):
        if layer["kind"] != "medium":
            raise ValueError(f"layers[{index}].kind = {layer['kind']}: only media can be shown as volumes")
        objects.append(_box(scene, half_width, top, medium_material(layer)))
        top -= THICKNESS + GAP
    base = stack.get("base")
    if base is not None:
        objects.append(_sheet(scene, half_width, top, base_material(base)))
    return objects


def medium_material(layer, thickness=THICKNESS):
    """A volume-only material with the layer's coefficients over a length `thickness`."""
    albedo, tau = _rgb(layer["albedo"]), _rgb(layer["tau"])
    largest = max(tau)
    # Cycles multiplies: sigma_s = colour * density, sigma_a = (1 - colour) * density.
    scatter = [a * t / largest if largest else 0.0 for a, t in zip(albedo, tau, strict=True)]
    absorb = [1.0 - (1.0 - a) * t / largest if largest else 1.0 for a, t in zip(albedo, tau, strict=True)]
    material = bpy.data.materials.new(f"volume {layer.get('name') or 'medium'}")
    tree = node_tree.of(material)
    tree.nodes.clear()
    scattering = tree.nodes.new("ShaderNodeVolumeScatter")
    _set_phase(scattering, layer["phase"])
    absorption = tree.nodes.new("ShaderNodeVolumeAbsorption")
    total = tree.nodes.new("ShaderNodeAddShader")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    for k, (node, colour) in enumerate(((scattering, scatter), (absorption, absorb))):
        node.inputs["Color"].default_value = (*colour, 1.0)
        node.inputs["Density"].default_value = largest / thickness
        tree.links.new(node.outputs[0], total.inputs[k])
    tree.links.new(total.outputs[0], output.inputs["Volume"])
    return material


def base_material(base):
    """A diffuse material for a Lambert base, or a black one."""
    if base["kind"] not in ("lambert", "black"):
        raise ValueError(f"base.kind = {base['kind']}: a volume can lie on lambert, black or none")
    reflectance = _rgb(base["reflectance"]) if base["kind"] == "lambert" else [0.0] * CHANNELS
    material = bpy.data.materials.new(f"base {base['kind']}")
    tree = node_tree.of(material)
    tree.nodes.clear()
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*reflectance, 1.0)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    return material


def plane(scene, half_width, material):
    """A single upward square at z = 0, for the baked material."""
    return _sheet(scene, half_width, 0.0, material)


def _set_phase(node, phase):
    if phase["kind"] == "rayleigh":
        node.phase = "RAYLEIGH"
        return
    if hasattr(node, "phase"):
        node.phase = "HENYEY_GREENSTEIN"
    node.inputs["Anisotropy"].default_value = phase.get("g", 0.0)


def _rgb(value):
    values = list(value) if isinstance(value, (list, tuple)) else [value]
    values = [float(v) for v in values]
    if len(values) not in (1, CHANNELS):
        raise ValueError(f"{len(values)} channels: Cycles has 3")
    return values * (CHANNELS // len(values))


def _box(scene, half_width, top, material):
    w, bottom = half_width, top - THICKNESS
    corners = [(x, y, z) for z in (bottom, top) for x, y in ((-w, -w), (w, -w), (w, w), (-w, w))]
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    return _object(scene, "volume", corners, faces, material)


def _sheet(scene, half_width, z, material):
    w = half_width
    return _object(scene, "sheet", [(-w, -w, z), (w, -w, z), (w, w, z), (-w, w, z)], [(0, 1, 2, 3)], material)


def _object(scene, name, corners, faces, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(thing)
    return thing

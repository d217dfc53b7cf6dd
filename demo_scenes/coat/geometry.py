# SPDX-License-Identifier: GPL-3.0-or-later
"""A coat as real geometry: a slab of glass whose lower face and edges are painted.

The paint touches the glass without air in between, as in the stack. Lengths have no effect, since light and view are
the same everywhere; the edges are too far away to be seen.
"""

import math

import bpy
import node_tree

THICKNESS = 0.5
# On a much wider slab, single precision lets rays leak through a face: .4 % of the light at a width of 10000.
HALF_WIDTH = 60.0
DISTRIBUTIONS = {"ggx": "GGX", "beckmann": "BECKMANN"}


def build(scene, stack):
    """Add the slab of a stack (a dict of one interface on a Lambert base), its top face at z = 0.

    Raises ValueError for other stacks, and for those that Cycles' glass cannot represent."""
    layers, base = stack["layers"], stack.get("base") or {"kind": "none"}
    if [layer["kind"] for layer in layers] != ["interface"]:
        raise ValueError(f"layers: {len(layers)} of them; a glass slab shows one interface")
    if base["kind"] != "lambert":
        raise ValueError(f"base.kind = {base['kind']}: a glass slab can lie on lambert")
    w, bottom = HALF_WIDTH, -THICKNESS
    corners = [(x, y, z) for z in (bottom, 0.0) for x, y in ((-w, -w), (w, -w), (w, w), (-w, w))]
    faces = [(4, 5, 6, 7), (3, 2, 1, 0), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    mesh = bpy.data.meshes.new("glass slab")
    mesh.from_pydata(corners, [], faces)
    for material in (glass(layers[0]), paint(base)):
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", [0, 1, 1, 1, 1, 1])
    thing = bpy.data.objects.new("glass slab", mesh)
    scene.collection.objects.link(thing)
    return thing


def plane(scene, material):
    """A single upward square at z = 0, for the baked material."""
    w = HALF_WIDTH
    mesh = bpy.data.meshes.new("baked plane")
    mesh.from_pydata([(-w, -w, 0.0), (w, -w, 0.0), (w, w, 0.0), (-w, w, 0.0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(material)
    thing = bpy.data.objects.new("baked plane", mesh)
    scene.collection.objects.link(thing)
    return thing


def glass(interface):
    """Cycles' Glass BSDF for an interface below air: with single scattering by facets, or, if the stack compensates the
    energy lost by it, with Cycles' own compensation."""
    alpha, ior = float(interface.get("alpha", 0.0)), interface["ior"]
    distribution = DISTRIBUTIONS[interface.get("distribution", "ggx")]
    compensate = interface.get("compensate", True)
    if not isinstance(ior, int | float):
        raise ValueError(f"layers[0].ior = {ior}: Cycles' glass has one index for all channels")
    if alpha > 0.0 and not interface.get("correlated", True):
        raise ValueError("layers[0].correlated = false: Cycles' glass masks both directions together")
    if alpha > 0.0 and compensate and distribution == "BECKMANN":
        raise ValueError("layers[0].compensate = true: Cycles' Beckmann facets scatter once")
    if alpha > 0.0 and compensate:
        distribution = "MULTI_GGX"
    node = "ShaderNodeBsdfGlass"
    inputs = {"Color": (1.0, 1.0, 1.0, 1.0), "Roughness": math.sqrt(alpha), "IOR": float(ior)}
    return _material("glass", node, inputs, distribution)


def paint(base):
    """A diffuse material of the base's reflectance."""
    value = base["reflectance"]
    value = value if isinstance(value, list) else [value]
    return _material("paint", "ShaderNodeBsdfDiffuse", {"Color": (*(value * (3 // len(value))), 1.0)})


def _material(name, node, inputs, distribution=None):
    material = bpy.data.materials.new(name)
    tree = node_tree.of(material)
    tree.nodes.clear()
    shader = tree.nodes.new(node)
    if distribution:
        shader.distribution = distribution
    for key, value in inputs.items():
        shader.inputs[key].default_value = value
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material

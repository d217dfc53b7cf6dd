# SPDX-License-Identifier: GPL-3.0-or-later
"""The same bronze three times: clean, under light dust, under heavy dust; or once, on a turntable. In metres.

All copies share a mesh and its dust, settled once. Dust is proportional to time, so each object has its share of the
thickness as the property SHARE, and the material multiplies thickness and share.
"""

import math
from pathlib import Path

import bpy
import extension
import mesh_file
import numpy as np

from . import plinth, settling, stage, strokes

SHARE = "dust_share"
SPACING, MARGIN = 0.298, 0.18  # m between figures; free margin at either side, half of the second, in figures
HEIGHT, WIDTH = 0.262, 0.21  # m, the box for any other mesh: it must stay on the plinth
PLINTH_RADIUS, PLINTH_HEIGHT = 0.118, 0.22 * 0.118
PLINTH_CENTRE = (-0.006, -0.006, 0.0)  # under the dragon's feet and tail
DRAGON = Path(__file__).resolve().parent / "dragon.ply.gz"  # in mm; tools/sculpting made it


def figure(mesh_path=None, up="y"):
    """The mesh to be shown: the dragon, or that of a file. Raises ValueError."""
    if mesh_path is None:
        vertices, sizes, corners = mesh_file.read(DRAGON)
        return mesh_file.as_mesh("dragon", 1e-3 * vertices - PLINTH_CENTRE, sizes, corners)
    return mesh_file.as_mesh("figure", *mesh_file.upright(mesh_path, WIDTH, HEIGHT, up))


def stand(fine=True):
    """The plinth's mesh."""
    vertices, quads, triangles = plinth.build(PLINTH_RADIUS, 0.0008 if fine else 0.0014)
    sizes = np.concatenate([np.full(len(quads), 4), np.full(len(triangles), 3)])
    mesh = mesh_file.as_mesh("plinth", vertices, sizes, np.concatenate([quads.ravel(), triangles.ravel()]))
    strokes.wipe(mesh, vertices)
    return mesh


def material(stack, quality, row_stride):
    """(material with dust of thickness attribute x share, its LUT). stack: a dict with a varying layer."""
    import lamina

    if not any(layer.get("varying") for layer in stack["layers"]):
        raise ValueError("layers: none of them is varying; the dust must be")
    stack_io, bake_job = extension.part("editing.stack_io"), extension.part("baking.bake_job")
    made = bpy.data.materials.new("dusty bronze")
    described = lamina.Stack.from_json(stack)
    stack_io.assign_stack(made, described)
    lut = lamina.bake(described, quality, row_stride=row_stride)
    bake_job.apply(made, lut)
    tree = made.node_tree
    group = next(node for node in tree.nodes if node.type == "GROUP")
    product = tree.nodes.new("ShaderNodeMath")
    product.operation = "MULTIPLY"
    for k, (kind, name) in enumerate((("GEOMETRY", lamina.dust.ATTRIBUTE), ("OBJECT", SHARE))):
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_type, attribute.attribute_name = kind, name
        tree.links.new(attribute.outputs["Fac"], product.inputs[k])
    tree.links.new(product.outputs[0], group.inputs["Thickness"])
    detail = extension.part("nodes.detail_wiring").add_detail(made)
    wiped = tree.nodes.new("ShaderNodeAttribute")
    wiped.attribute_type, wiped.attribute_name = "GEOMETRY", strokes.ATTRIBUTE
    tree.links.new(wiped.outputs["Fac"], detail.inputs["Wiped"])
    return made, lut


def build(figure_mesh, stand_mesh, dusty, shares):
    """(scene, its [(figure, plinth)] from left to right). shares: of the settled dust, one per figure."""
    made = bpy.data.scenes.new("dragon")
    eye = stage.build(made, 0.110, SPACING * (len(shares) + MARGIN))
    for mesh in (figure_mesh, stand_mesh):
        mesh.materials.clear()
        mesh.materials.append(dusty)
    groups = []
    for k, share in enumerate(shares):
        place = stage.RIGHT * (k - 0.5 * (len(shares) - 1)) * SPACING
        # Turn the same side of each figure to the viewer.
        seen = eye.location - place
        turn = math.atan2(seen.y, seen.x) - stage.CAMERA_AZIMUTH
        groups.append([_put(made, mesh, place, turn, share) for mesh in (figure_mesh, stand_mesh)])
    stage.paper(made, -PLINTH_HEIGHT, 0.9, 4.0)
    made.view_layers[0].update()
    return made, groups


def settle(group, amount, rays):
    """Let dust settle on a figure and its plinth, for all objects that share their meshes; statistics of both by
    name."""
    figure, stand = group
    return {"figure": settling.settle_on(figure, amount, [stand], rays),
            "plinth": settling.settle_on(stand, amount, [figure], rays)}


def _put(scene, mesh, place, turn, share):
    thing = bpy.data.objects.new(mesh.name, mesh)
    thing.location, thing.rotation_euler = place, (0.0, 0.0, turn)
    thing[SHARE] = float(share)
    scene.collection.objects.link(thing)
    return thing

# SPDX-License-Identifier: GPL-3.0-or-later
"""Veins as Blender nodes: one number, the share of the vein material, at each position inside an object.

The same nodes are read by Cycles' volume (the truth) and by the add-on's sampling into voxels. One Blender unit is one
millimetre.
"""

import dataclasses

import bpy
import node_tree
import numpy as np

CHANNELS = 3
# White marble: Jensen, Marschner, Levoy and Hanrahan 2001, measured; reduced scattering in 1/mm, hence isotropic.
# The veins' coefficients are chosen.
WHITE = ((2.19, 2.62, 3.00), (0.0021, 0.0041, 0.0071))  # sigma_s, sigma_a
VEIN = ((1.1, 1.3, 1.5), (0.30, 0.24, 0.19))


@dataclasses.dataclass(frozen=True)
class Veins:
    """Parallel veins distorted by noise. Lengths in mm."""

    spacing: float = 5.0
    turn: tuple = (0.5, -0.35, 0.6)  # radians: Euler angles between the veins' planes and the object
    distortion: float = 5.0
    feature: float = 4.0  # size of the largest distortions
    octaves: float = 1.0  # of the noise beyond the first
    edge: float = 0.72  # the wave, 0 to 1, above which a vein begins

    def draw(self, tree):
        """Add the nodes to a material's tree and return the socket with the share of the vein, 0 to 1."""
        place = tree.nodes.new("ShaderNodeTexCoord")
        turn = tree.nodes.new("ShaderNodeMapping")
        turn.inputs["Rotation"].default_value = self.turn
        wave = tree.nodes.new("ShaderNodeTexWave")
        # Cycles' wave of scale s has the period 2 pi / (20 s).
        scale = 2.0 * np.pi / (20.0 * self.spacing)
        wave.inputs["Scale"].default_value = scale
        wave.inputs["Distortion"].default_value = self.distortion
        wave.inputs["Detail"].default_value = self.octaves
        # The noise of the distortion reads position times Scale times Detail Scale.
        wave.inputs["Detail Scale"].default_value = 1.0 / (self.feature * scale)
        share = tree.nodes.new("ShaderNodeMapRange")
        share.interpolation_type, share.clamp = "SMOOTHSTEP", True
        share.inputs["From Min"].default_value = self.edge
        tree.links.new(place.outputs["Object"], turn.inputs["Vector"])
        tree.links.new(turn.outputs[0], wave.inputs["Vector"])
        tree.links.new(wave.outputs["Fac"], share.inputs["Value"])
        return share.outputs["Result"]


def material(veins):
    """A material whose base colour is the share of the vein: the texture that an interior samples."""
    made = bpy.data.materials.new("veins")
    tree = node_tree.of(made)
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    tree.links.new(veins.draw(tree), shader.inputs["Base Color"])
    return made


def volume(veins):
    """A material without a surface whose volume has the coefficients of the mixture of WHITE and VEIN."""
    made = bpy.data.materials.new("volume")
    tree = node_tree.of(made)
    tree.nodes.clear()
    share = veins.draw(tree)
    density = max(s + a for end in (WHITE, VEIN) for s, a in zip(*end, strict=True))
    output, total = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeAddShader")
    scattering, absorption = tree.nodes.new("ShaderNodeVolumeScatter"), tree.nodes.new("ShaderNodeVolumeAbsorption")
    # Cycles multiplies: sigma_s = colour * density, sigma_a = (1 - colour) * density.
    colours = [[np.array(end[0]) / density for end in (WHITE, VEIN)],
               [1.0 - np.array(end[1]) / density for end in (WHITE, VEIN)]]
    for k, (node, ends) in enumerate(zip((scattering, absorption), colours, strict=True)):
        tree.links.new(mixed(tree, share, *ends), node.inputs["Color"])
        node.inputs["Density"].default_value = density
        tree.links.new(node.outputs[0], total.inputs[k])
    scattering.inputs["Anisotropy"].default_value = 0.0
    tree.links.new(total.outputs[0], output.inputs["Volume"])
    return made


def mixed(tree, share, ground, vein):
    """A socket with the colour ground + share (vein - ground)."""
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    mix.clamp_factor = mix.clamp_result = False
    colours = [socket for socket in mix.inputs if socket.type == "RGBA"]
    for socket, colour in zip(colours, (ground, vein), strict=True):
        socket.default_value = (*map(float, colour), 1.0)
    tree.links.new(share, mix.inputs[0])
    return next(socket for socket in mix.outputs if socket.type == "RGBA")

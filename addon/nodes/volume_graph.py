# SPDX-License-Identifier: GPL-3.0-or-later
"""A body as a volume that Cycles renders: one homogeneous medium, below a boundary or none. Right for bodies
of all shapes, also for deforming meshes and instances; noisy where light is scattered many times."""

from math import ceil, log
from typing import NamedTuple

MOST = 1024  # volume bounces of Cycles, at most
_GLASS = "ShaderNodeBsdfGlass"
_LOST = 0.002  # of the light of a body without end, by paths that end after the bounces


class Body(NamedTuple):
    """A lamina.EndMaterial in 1/mm, and its Surface."""

    medium: object
    surface: object

    @property
    def hides_lamps(self):
        """True below a boundary, through which suns and small lamps shine by chance only."""
        return self.surface.ior != 1.0

    @property
    def bounces(self):
        """Scatterings after which paths may end."""
        pairs = zip(self.medium.sigma_s, self.medium.sigma_a, strict=True)
        albedo = max((s / (s + a) for s, a in pairs if s + a > 0.0), default=0.0)
        if albedo <= 0.0:
            return 1
        return MOST if albedo >= 1.0 else min(MOST, ceil(log(_LOST) / log(albedo)) + 1)

    @property
    def report(self):
        """One or two sentences on noise."""
        text = f"Cycles follows up to {self.bounces} scatterings. This is right for closed bodies, and noisy."
        if not self.hides_lamps:
            return text
        return f"{text} Suns and small lamps shine through the boundary by chance only: use Exact for them."


def has_boundary(material):
    """True if the material shows a volume below a boundary."""
    group = material.lamina.lateral_group
    return group is not None and any(node.bl_idname == _GLASS for node in group.nodes)


def draw(graph, body, length):
    """Add the nodes and return the sockets of the shader and of the volume. `length`: the number of
    Blender units per millimetre, a value."""
    surface = body.surface
    if surface.ior == 1.0:
        face = graph.node("ShaderNodeBsdfTransparent", "no boundary")
    else:
        face = graph.node(_GLASS, "boundary")
        # Without the light that facets scatter several times, a rough boundary of IOR 1.3 lost 10 %.
        face.distribution = "MULTI_GGX" if surface.distribution == "ggx" else "BECKMANN"
        face.inputs["IOR"].default_value = surface.ior
        face.inputs["Roughness"].default_value = surface.alpha**0.5  # as in boundary_graph
    face.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    return face.outputs[0], _volume(graph, body.medium, length)


def _volume(graph, medium, length):
    largest = max(*medium.sigma_s, *medium.sigma_a, 1e-12)
    density = (largest / length).named("in Blender units")
    scatter = graph.node("ShaderNodeVolumeScatter", "scattered")
    scatter.inputs["Color"].default_value = (*(value / largest for value in medium.sigma_s), 1.0)
    scatter.inputs["Anisotropy"].default_value = medium.g
    absorb = graph.node("ShaderNodeVolumeAbsorption", "absorbed")
    # The closure absorbs its density times (1 - colour).
    absorb.inputs["Color"].default_value = (*(1.0 - value / largest for value in medium.sigma_a), 1.0)
    for node in (scatter, absorb):
        graph.link(density, node.inputs["Density"])
    return graph.add_shaders("the volume", scatter.outputs[0], absorb.outputs[0])

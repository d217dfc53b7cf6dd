# SPDX-License-Identifier: GPL-3.0-or-later
"""A dielectric boundary over another shader, or over emitted light."""

from . import mix_shader


def over(graph, ior, alpha, shader):
    """The shader under a boundary of this index and facet width, which mirrors by Fresnel's equations."""
    mix = _mirrored(graph, ior, alpha, "boundary over all else")
    graph.link(shader, mix.inputs[1])
    return mix.outputs[0]


def beside(graph, ior, alpha, shader):
    """The shader plus the light that such a boundary mirrors, for a shader that is already weakened by the
    boundary."""
    mirrored = _mirrored(graph, ior, alpha, "mirrored light").outputs[0]
    return mix_shader.added(graph, 7, 0, "with mirrored light", shader, mirrored)


def _mirrored(graph, ior, alpha, label):
    """A Mix Shader node that mirrors by Fresnel's equations; its first shader is not linked."""
    fresnel = graph.node("ShaderNodeFresnel", 5, -4, "boundary")
    fresnel.inputs["IOR"].default_value = ior
    glossy = graph.node("ShaderNodeBsdfAnisotropic", 5, -2, "boundary")
    glossy.distribution = "GGX"
    glossy.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    glossy.inputs["Roughness"].default_value = alpha**0.5  # Blender's roughness is the root of alpha
    mix = graph.node("ShaderNodeMixShader", 6, 0, label)
    graph.link(fresnel.outputs[0], mix.inputs[0])
    graph.link(glossy.outputs[0], mix.inputs[2])
    return mix

# SPDX-License-Identifier: GPL-3.0-or-later
"""A dielectric boundary over another shader."""


def over(graph, ior, alpha, shader):
    """The shader under a boundary of this index and facet width, which mirrors by Fresnel's equations."""
    fresnel = graph.node("ShaderNodeFresnel", 5, -4, "boundary")
    fresnel.inputs["IOR"].default_value = ior
    glossy = graph.node("ShaderNodeBsdfAnisotropic", 5, -2, "boundary")
    glossy.distribution = "GGX"
    glossy.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    glossy.inputs["Roughness"].default_value = alpha**0.5  # Blender's roughness is the root of alpha
    mix = graph.node("ShaderNodeMixShader", 6, 0, "boundary over all else")
    graph.link(fresnel.outputs[0], mix.inputs[0])
    graph.link(shader, mix.inputs[1])
    graph.link(glossy.outputs[0], mix.inputs[2])
    return mix.outputs[0]

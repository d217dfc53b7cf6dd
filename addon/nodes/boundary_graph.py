# SPDX-License-Identifier: GPL-3.0-or-later
"""A dielectric boundary over another shader, or over emitted light."""



def over(graph, ior, alpha, shader):
    """The shader under a boundary of this index and facet width, which mirrors by Fresnel's equations."""
    share, mirror = reflectance(graph, ior), _mirror(graph, alpha)
    return graph.mix_shaders("boundary over all else", share, shader, mirror)


def beside(graph, share, alpha, shader):
    """The shader plus the light that such a boundary mirrors, for a shader that is already weakened by the
    boundary. `share`: that of `reflectance`."""
    mirrored = graph.weighted_shader("mirrored light", share, _mirror(graph, alpha))
    return graph.add_shaders("with mirrored light", shader, mirrored)


def reflectance(graph, ior):
    """The share of light that a boundary of this index mirrors towards the eye, by Fresnel's
    equations."""
    fresnel = graph.node("ShaderNodeFresnel", "boundary")
    fresnel.inputs["IOR"].default_value = ior
    return graph.value(fresnel.outputs[0])


def _mirror(graph, alpha):
    glossy = graph.node("ShaderNodeBsdfAnisotropic", "boundary")
    glossy.distribution = "GGX"
    glossy.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    glossy.inputs["Roughness"].default_value = alpha**0.5  # Blender's roughness is the root of alpha
    return glossy.outputs[0]

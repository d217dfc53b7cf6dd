# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures and sums of two shaders, and a shader times a number."""


def between(graph, label, factor, first, second):
    """The shader `first` at the factor 0, and `second` at 1. `factor`: a number or a socket."""
    mix = graph.node("ShaderNodeMixShader", label)
    graph.set(mix.inputs[0], factor)
    graph.link(first, mix.inputs[1])
    graph.link(second, mix.inputs[2])
    return mix.outputs[0]


def weighted(graph, label, weight, shader):
    """The shader times `weight`, a number or a socket, from 0 to 1: its mixture with no shader."""
    mix = graph.node("ShaderNodeMixShader", label)
    graph.set(mix.inputs[0], weight)
    graph.link(shader, mix.inputs[2])
    return mix.outputs[0]


def added(graph, label, first, second):
    """The sum of two shaders."""
    both = graph.node("ShaderNodeAddShader", label)
    graph.link(first, both.inputs[0])
    graph.link(second, both.inputs[1])
    return both.outputs[0]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over the material as it is: the stack's base is what the material shows now.

A Principled BSDF becomes a base with the same values. Any other shader stays in use and is seen through the
layers, which is approximate. So does a Principled BSDF with transmission, subsurface scattering or sheen,
which the base does not have, unless the artist wants its values.
"""

from ..base import changes, messages, renders
from ..base.messages import RefusedError
from ..kinds.bases import PrincipledBase, ShaderBase
from ..nodes import before, in_place, links, mean_reflectance, node_group, node_tree, principled
from ..stack_json import stack_write
from . import layer_list, stack_io

# Of the first layer: the material stays visible. The color is that of a thick layer of house dust.
DUST = {"mode": "colour", "tau": 0.3, "colour": (0.38, 0.33, 0.26)}

TWICE = "The material has Lamina layers already"
_APPROXIMATE = (
    "Approximate, because the shader stays in use below the layers: they do not blur or tint its light. The "
    "panel shows the error after the bake"
)
_CORRECTION = (
    "bump map correction (the layers switch it off: matte surfaces get up to 10 % brighter where bump and "
    "normal maps tilt them)"
)


def problem(material):
    """Why layers cannot be put over `material`, in a sentence, or ''."""
    if material.lamina.enabled:
        return TWICE
    if material.node_tree is not None and not node_tree.is_on(material):
        return "Use Nodes is off for this material: switch it on, or make new layers"
    if principled.shown(material) is None:
        return "No shader is linked to the Surface of the material output"
    return ""


def keeps_shader(material):
    """True if the shader of `material` stays in use below layers unless the artist decides otherwise: if it
    is no Principled BSDF, or one with parts that a base lacks."""
    node = principled.find(material)
    return node is None or principled.is_more_than_base(node)


def has_choice(material):
    """True if the artist may choose between the shader of `material` and its values."""
    return principled.find(material) is not None


def not_carried(material, keep_shader=None):
    """What layers over `material` cannot carry: a list of short texts. `keep_shader`: as in `add`."""
    keep_shader = keeps_shader(material) if keep_shader is None else keep_shader
    node, shader = principled.find(material), principled.shown(material)
    texts = [] if node is None or keep_shader else principled.not_carried(node)
    shaders = [] if shader is None else list(links.upstream(shader.node))
    if before.corrects(material) and principled.has_normals(shaders):
        texts.append(_CORRECTION)
    return texts


def told(material, width, keep_shader=None):
    """What the artist should know before layers are put over `material`, as lines of a panel or dialog:
    (text, icon) each. `width`: of a line, in characters. `keep_shader`: as in `add`."""
    keep_shader = keeps_shader(material) if keep_shader is None else keep_shader
    lines = _lines(_APPROXIMATE, width, "INFO") if keep_shader else []
    texts = not_carried(material, keep_shader)
    lines += [("Not carried over:", "INFO")] if texts else []
    for text in texts:
        lines += _lines(text, width, "DOT")
    return lines


def _lines(text, width, icon):
    """The lines of a text, with an icon before the first."""
    first, *others = messages.wrapped(text, width)
    return [(first, icon), *((line, "BLANK1") for line in others)]


def add(material, keep_shader=None):
    """Give `material` a first stack, a thin layer of dust, over what the material shows now. The nodes are
    changed by the first bake. Raises RefusedError.

    `keep_shader`: a Principled BSDF stays in use as well, instead of its values alone; None: as
    `keeps_shader` says."""
    sentence = problem(material)
    if sentence:
        raise RefusedError(sentence)
    node, shader = principled.find(material), principled.shown(material)
    keep_shader = keeps_shader(material) if keep_shader is None else keep_shader
    if keep_shader:
        node = None
    settings = material.lamina
    is_new = not settings.layers
    layer_list.add_stack(material)
    if is_new:
        for name, value in DUST.items():
            setattr(settings.layers[0], name, value)
    base = settings.base
    if node is None:
        base.kind = ShaderBase.kind
        base.shader_reflectance = mean_reflectance.of(shader)
    else:
        base.kind = PrincipledBase.kind
        _take_values(base, node)
    changes.tell(material)


def has_changed(material):
    """True if the Principled BSDF below the layers was edited after they have read it: the edits have no
    effect before `read_again`."""
    return in_place.has_changed(material)


def read_again(material):
    """Give the base of `material` and the layers' node what the Principled BSDF in the frame “Before Lamina”
    has now. A bake shows the new values. Raises RefusedError if no such node is there."""
    node = in_place.replaced(material)
    if node is None:
        raise RefusedError(f"{material.name} has no layers over the values of a Principled BSDF")
    renders.stop_previews()
    _take_values(material.lamina.base, node)
    in_place.read_again(material, node_group.group_nodes(material))
    changes.tell(material)


def _take_values(base, node):
    values = principled.values(node)
    for field in PrincipledBase.fields:
        setattr(base, field.prop, values[field.name])
    base.inputs = principled.inputs(node)


def is_over(material):
    """True if the layers of `material` lie over what its nodes show."""
    return material.lamina.enabled and material.lamina.base.kind in (PrincipledBase.kind, ShaderBase.kind)


def layers_problem(stack):
    """Why the layers of a `lamina.Stack` cannot be put over a material, in a sentence, or ''."""
    name = stack.name or "The stack"
    if not stack.layers:
        return f"{name} has no layers that could lie over this material"
    if stack.layers[-1].kind == "film":
        return f"{name} has a thin film on its own metal, which cannot lie over this material"
    return ""


def assign_layers(material, stack):
    """Replace the layers of `material` by those of a `lamina.Stack`; the base stays. Raises RefusedError."""
    sentence = layers_problem(stack)
    if sentence:
        raise RefusedError(sentence)
    stack_io.assign(material, {**stack.to_json(), "base": stack_write.base(material.lamina.base)})

# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over the material as it is: the stack's base is what the material shows now.

A Principled BSDF becomes a base with the same values. Any other shader stays in use and is seen through the
layers, which is approximate.
"""

from ..base import changes, messages
from ..base.messages import RefusedError
from ..kinds.bases import PrincipledBase, ShaderBase
from ..nodes import before, mean_reflectance, principled
from ..stack_json import stack_write
from . import layer_list, stack_io

QUALITY = "preview"  # of the first bake, which should take seconds
DUST = {"tau": 0.3, "albedo": (0.9, 0.9, 0.9)}  # of the first layer: the material stays visible

_APPROXIMATE = (
    "Approximate, because the material is not one Principled BSDF: the layers do not blur or tint the light "
    "of the shader below. The panel shows the error after the bake"
)


def problem(material):
    """Why layers cannot be put over `material`, in a sentence, or ''."""
    if material.lamina.enabled:
        return "The material has Lamina layers already"
    if principled.shown(material) is None:
        return "No shader is linked to the Surface of the material output"
    return ""


def not_carried(material):
    """What layers over `material` cannot carry: a list of short texts."""
    node = principled.find(material)
    return [] if node is None else principled.not_carried(node)


def told(material, width):
    """What the artist should know before layers are put over `material`, as lines of a panel or dialog:
    (text, icon) each. `width`: of a line, in characters."""
    if principled.find(material) is None:
        return _lines(_APPROXIMATE, width, "INFO")
    texts = not_carried(material)
    lines = [("Not carried over:", "INFO")] if texts else []
    for text in texts:
        lines += _lines(text, width, "DOT")
    return lines


def _lines(text, width, icon):
    """The lines of a text, with an icon before the first."""
    first, *others = messages.wrapped(text, width)
    return [(first, icon), *((line, "BLANK1") for line in others)]


def add(material):
    """Give `material` a first stack, a thin layer of dust, over what the material shows now. The nodes are
    changed by the first bake. Raises RefusedError."""
    sentence = problem(material)
    if sentence:
        raise RefusedError(sentence)
    node, shader = principled.find(material), principled.shown(material)
    settings = material.lamina
    is_new = not settings.layers
    layer_list.add_stack(material)
    if is_new:
        for name, value in DUST.items():
            setattr(settings.layers[0], name, value)
    settings.quality = QUALITY
    base = settings.base
    if node is None:
        base.kind = ShaderBase.kind
        base.shader_reflectance = mean_reflectance.of(shader)
    else:
        base.kind = PrincipledBase.kind
        values = principled.values(node)
        for field in PrincipledBase.fields:
            setattr(base, field.prop, values[field.name])
        base.inputs = principled.inputs(node)
    changes.tell(material)


def is_over(material):
    """True if the layers of `material` lie over what its nodes show."""
    return material.lamina.enabled and material.lamina.base.kind in (PrincipledBase.kind, ShaderBase.kind)


def assign_layers(material, stack):
    """Replace the layers of `material`, which lie over what its nodes show, by those of a `lamina.Stack`.

    The base stays what the nodes show. Raises RefusedError."""
    data = stack.to_json()
    if not data["layers"]:
        name = data.get("name") or "The stack"
        raise RefusedError(f"{name} has no layers that could lie over this material")
    if _principled_below(material) is not None:
        material.lamina.base.kind = PrincipledBase.kind
    stack_io.assign(material, {**data, "base": stack_write.base(material.lamina.base)})


def _principled_below(material):
    """The Principled BSDF below the layers, or None."""
    if material.lamina.node_group is None:
        return principled.find(material)
    return principled.of(before.source(material.node_tree))

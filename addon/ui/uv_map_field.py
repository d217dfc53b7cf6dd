# SPDX-License-Identifier: GPL-3.0-or-later
"""The field that names a UV map, with a message if the field is empty or names a missing map."""

from ..base import uv_maps
from .sentences import draw_sentence


def draw_uv_map(context, layout, owner, thing):
    """The field `uv_map` of `owner` for the mesh object `thing`."""
    layout.prop_search(owner, "uv_map", thing.data, "uv_layers", text="UV Map")
    # Modifiers can add UV maps, or remove them.
    mesh = thing.evaluated_get(context.evaluated_depsgraph_get()).data
    sentence, is_fault = uv_maps.choice(thing, mesh, owner.uv_map)
    if sentence:
        draw_sentence(context, layout, sentence, "ERROR" if is_fault else "INFO", alert=is_fault)

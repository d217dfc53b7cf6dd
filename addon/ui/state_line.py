# SPDX-License-Identifier: GPL-3.0-or-later
"""What the material shows now, beside a picture of it: the state of its update and errors, in sentences."""

from ..baking import bake_job, lateral_job, update
from ..base import messages, native
from ..editing import match_job, stack_io
from ..nodes import node_group
from ..stack_json import solved_colours, stack_check
from . import numbers, result_picture
from .sentences import draw_progress, draw_sentence

_ROW = 0.32  # of the panel's width: the picture
# What is shown while an update is due.
_SHOWN = {
    "none": "Not shown yet",
    "stale": "The layers before the last change",
    "other": "A coarse picture of these layers",
}


def draw(context, layout, material):
    """The picture, the state with what may be done about it, and errors in sentences."""
    split = layout.split(factor=_ROW)
    if result_picture.draw_ball(split.column(), context, material):
        column = split.column()
    else:
        column = layout.column()
    state = _state(material)
    _draw_state(context, column, material, state)
    failure = bake_job.failure(material) or stack_error(material)
    if failure:
        draw_sentence(context, layout, failure, "ERROR", alert=True)
    elif state == "fresh" and (warning := numbers.warning(material.lamina.result)):
        draw_sentence(context, layout, warning, "ERROR")
    if node_group.shows_lateral(material):
        sentence = lateral_job.stale(material) or "The output shows light below the surface instead"
        draw_sentence(context, layout, f"{sentence}, see Depth")
    elif material.lamina.node_group is not None and not node_group.is_connected(material):
        row = layout.row()
        row.label(text="Not connected to the output", icon="UNLINKED")
        row.operator("lamina.connect", text="Connect")


def told(material):
    """(sentence, icon): what is shown now."""
    return _told(material, _state(material))


def error_layer(material):
    """Index of the layer with the stack's error, or None."""
    error = _error(material)
    return None if error is None else messages.layer_index(str(error))


def stack_error(material):
    """The fault in the layers as they are now, as a sentence, or ''."""
    error = _error(material)
    return "" if error is None else messages.sentence(error, material)


def _draw_state(context, column, material, state):
    for jobs, work in ((bake_job, "BAKE"), (update, "UPDATE"), (match_job, "MATCH")):
        job = jobs.running_for(material)
        if job is not None:
            draw_progress(column, job, work, tall=False)
            return
    draw_sentence(context, column, *_told(material, state))
    if state not in ("fresh", "invalid") and not update.is_pending(material):
        column.operator("lamina.bake", icon="FILE_REFRESH")


def _state(material):
    if not native.available():
        return "unknown"
    is_known = _is_checked(material) or not material.lamina.result.stack_hash
    return bake_job.state(material) if is_known else "stale"


def _told(material, state):
    if state in _SHOWN and update.is_pending(material):
        return f"{_SHOWN[state]}; the full one follows", "SORTTIME"
    if state == "fresh":
        return "Up to date", "CHECKMARK"
    if state == "none":
        if material.lamina.result.stack_hash:
            return "The nodes or the table of the last update are gone", "ERROR"
        return "Not shown yet", "INFO"
    if state == "invalid":
        return "Out of date: the layers cannot be baked as they are", "ERROR"
    if state == "other":
        return f"Out of date: baked with {bake_job.difference(material)}", "FILE_REFRESH"
    if state == "older":
        return f"Out of date: {bake_job.version_difference(material)}", "FILE_REFRESH"
    return ("Out of date: the layers have changed" if state == "stale" else ""), "FILE_REFRESH"


def _is_checked(material):
    """True if the stack can be checked while the panel is drawn. If not, the panel is drawn again later."""
    return solved_colours.is_checked(material, stack_io.to_text(material))


def _error(material):
    """The error in the layers as they are now, or None."""
    if not native.available() or not _is_checked(material):
        return None
    return stack_check.of(stack_io.to_text(material))[1]

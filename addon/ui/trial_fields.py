# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the trial of the nodes on show on the active object, and what the trial has found."""

from ..interior import trial
from ..nodes import volume_graph
from .sentences import draw_progress, draw_sentence


def draw(context, layout):
    material = context.material
    job = trial.running_for(material)
    if job is not None:
        draw_progress(layout, job, "TRIAL", tall=False)
        return
    if material.lamina.trial:
        draw_sentence(context, layout, material.lamina.trial, "CHECKMARK")
    if not volume_graph.has_boundary(material):
        layout.operator("lamina.trial")

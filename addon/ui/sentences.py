# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences, lines of values and progress bars in panels."""

from ..base import messages


def draw_sentence(context, layout, text, icon="INFO", alert=False):
    """A sentence, wrapped to the panel's width."""
    column = layout.column(align=True)
    column.alert = alert
    for number, line in enumerate(messages.wrapped(text, characters(context))):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")


def draw_lines(layout, lines):
    """A column of (name, value)."""
    column = layout.column(align=True)
    for name, value in lines:
        split = column.split(factor=0.4)
        label = split.row()
        label.alignment = "RIGHT"
        label.label(text=name)
        split.label(text=value)


def draw_progress(layout, job, work, tall=True):
    """A worker's progress bar, and the operator that cancels `work`, an item of that operator. What the
    worker says after a comma, such as the time left, is too long for the bar and gets a line of its own."""
    row = layout.row(align=True)
    row.scale_y = 1.4 if tall else 1.0
    said, _, more = job.text.partition(", ")
    row.progress(factor=job.fraction, text="Cancelling" if job.cancelling else f"{job.fraction:.0%}  {said}")
    row.operator("lamina.cancel", text="", icon="CANCEL").work = work
    if more and not job.cancelling:
        layout.label(text=f"{more[0].upper()}{more[1:]}", icon="TIME")


def characters(context):
    """The number of characters that fit into a line of the panel, beside an icon."""
    scale = context.preferences.system.ui_scale
    return max(int((context.region.width / scale - 70.0) / 6.4), 20)

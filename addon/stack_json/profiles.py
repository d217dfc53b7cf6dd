# SPDX-License-Identifier: GPL-3.0-or-later
"""Media that change with depth.

The panel has numbers for a top and a bottom; a profile of more depths is kept word for word as text, so
nothing is lost.
"""

from . import kept_json


def is_graded(layer):
    """Whether a medium changes with depth."""
    return layer.graded or bool(layer.profile_text)


def imported(layer):
    """'5 depths': what the text holds; '' when the panel edits the profile."""
    if not layer.profile_text:
        return ""
    held = knots(layer)
    return held if held == kept_json.UNREADABLE else f"{len(held)} depths"


def knots(layer):
    """The imported knots, as JSON data. A damaged text gives what `lamina` refuses."""
    return kept_json.parsed(layer.profile_text, list)


def replace(layer):
    """Let go of an imported profile: the panel's own top and bottom, which are its ends, take its place."""
    layer.profile_text = ""

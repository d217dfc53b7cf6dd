# SPDX-License-Identifier: GPL-3.0-or-later
"""Media that change with depth.

The panel edits a top and a bottom. A profile of more depths is stored unchanged as text.
"""

from ..kinds import media
from . import kept_json


def is_graded(layer):
    """True if a medium changes with depth. The amount of a pigment does not."""
    return (layer.graded and layer.mode != media.BY_PIGMENT.item.id) or bool(layer.profile_text)


def imported(layer):
    """The stored profile in short, such as '5 depths'; '' if the panel edits the profile."""
    if not layer.profile_text:
        return ""
    held = knots(layer)
    return held if held == kept_json.UNREADABLE else f"{len(held)} depths"


def knots(layer):
    """The imported knots, as JSON data. Damaged JSON gives a value that `lamina` refuses."""
    return kept_json.parsed(layer.profile_text, list)


def replace(layer):
    """Discard an imported profile; the panel's top and bottom, which equal its ends, replace it."""
    layer.profile_text = ""

# SPDX-License-Identifier: GPL-3.0-or-later
"""The medium that shows two given colors: over black and over white, as on a drawdown card, or as one coat
and as several."""

import math

from ..base import native
from ..base.messages import RefusedError
from ..kinds.limits import STACK_SCHEMA
from ..stack_json import phases, profiles

OPAQUE = 100.0  # optical thickness of a channel that hides what lies below, where others do not


def can_match(layer):
    """True for a medium that is the same at all depths."""
    return layer is not None and layer.kind == "medium" and not profiles.is_graded(layer)


def match(layer, over_black, over_white, white):
    """Give the medium `layer` the albedo and the optical thickness with which it shows `over_black` on black
    and `over_white` on a surface of reflectance `white`: linear red, green, blue. Its phase function stays.
    Raises RefusedError, lamina.StackError, NativeMissingError; then nothing is changed."""
    _give(layer, native.part("colours").match(list(over_black), list(over_white), _phase(layer), white))


def match_coats(layer, once, twice, over, times):
    """Like `match`, from the colors of one coat and of one that is `times` as thick, both on a surface of
    color `over`. The layer becomes one coat."""
    find = native.part("colours").match_coats
    _give(layer, find(list(once), list(twice), list(over), _phase(layer), times))


def _phase(layer):
    if not can_match(layer):
        raise RefusedError("only a medium that does not change with depth can match colors")
    known = {"kind": "medium", "albedo": 0.5, "tau": 1.0, "phase": phases.to_json(layer)}
    return native.require().Stack.from_json({"schema": STACK_SCHEMA, "layers": [known]}).layers[0].phase


def _give(layer, found):
    layer.mode, layer.albedo = "optical", found.albedo
    layer.infinite = all(tau == math.inf for tau in found.tau)
    if not layer.infinite:
        taus = [min(tau, OPAQUE) for tau in found.tau]
        layer.tau_per_channel, layer.tau_rgb, layer.tau = len(set(taus)) > 1, taus, max(taus)

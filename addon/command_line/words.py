# SPDX-License-Identifier: GPL-3.0-or-later
"""What the batch says of a bake, in words and as JSON."""

from ..baking import bake_job
from ..base import native
from ..base.messages import percent
from ..nodes import node_group


def state_of(material, quality=None, basis=None):
    """The state of the material's bake as in bake_job.state; 'broken' if it is fresh, but the node group is
    not whole."""
    found = bake_job.state(material, quality, basis)
    return "broken" if found == "fresh" and not node_group.is_whole(material) else found


def state(material, quality=None, basis=None):
    """The state of the material's bake in words; for a quality and basis, by default the material's own."""
    if not native.available():
        return "baked" if material.lamina.result.stack_hash else "not baked"
    found = state_of(material, quality, basis)
    difference = bake_job.difference(material, quality, basis)
    words = {
        "none": "not baked",
        "fresh": "up to date",
        "stale": "out of date",
        "live": f"live preview, {difference}",
        "other": f"out of date, baked with {difference}",
        "invalid": "cannot be baked",
        "broken": "the node group of the last bake is not whole",
    }
    return f"out of date, {bake_job.version_difference(material)}" if found == "older" else words[found]


def bake(result, seconds):
    """The accuracy of the last bake, as one line."""
    errors = f"fit error {percent(result.fit_error, 2)}, worst slice {percent(result.worst_error)}"
    if result.fit_error_transmission >= 0.0:
        errors += f", transmission {percent(result.fit_error_transmission, 2)}"
        errors += f", worst slice {percent(result.through_worst_error)}"
    return f"{errors}, {result.closures} closures, {result.basis}, {result.quality}, {seconds:.2f} s"


def facts(result):
    """The last bake as JSON; None before the first."""
    if not result.stack_hash:
        return None
    errors = {
        "fit_error": result.fit_error,
        "worst_slice": result.worst_error,
        "fit_error_transmission": result.fit_error_transmission,
        "worst_slice_transmission": result.through_worst_error,
        "between_rows": result.between_rows,
        "albedo_error": result.albedo_error,
        "energy_error": result.energy_error,
    }
    return {
        "stack_hash": result.stack_hash,
        "lamina": result.version or None,
        "quality": result.quality,
        "basis": result.basis or "standard",
        "closures": result.closures,
        "errors": {name: value if value >= 0.0 else None for name, value in errors.items()},
    }

# SPDX-License-Identifier: GPL-3.0-or-later
"""What the batch says of a bake, in words and as JSON."""

from ..baking import bake_job
from ..base import native, preferences
from ..base.messages import percent
from ..nodes import node_group


def state_of(material, quality=None, basis=None):
    """The state of the material's bake as in bake_job.state; 'broken' if there is a bake, but its node group
    is not whole."""
    found, settings = bake_job.state(material, quality, basis), material.lamina
    is_partial = found == "fresh" and not node_group.is_whole(material)
    is_lost = found == "none" and settings.result.stack_hash and settings.node_group is not None
    return "broken" if is_partial or is_lost else found


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
        "other": f"out of date, baked with {difference}",
        "invalid": "cannot be baked",
        "broken": "the node group of the last bake is not whole",
    }
    return f"out of date, {bake_job.version_difference(material)}" if found == "older" else words[found]


def bake(result, seconds):
    """The accuracy of the last bake, as one line."""
    report = result.report
    errors = f"fit error {percent(report['fit_error'], 2)}"
    errors += f", worst slice {percent(report['worst_slice']['error'])}"
    if report["fit_error_transmission"] is not None:
        errors += f", transmission {percent(report['fit_error_transmission'], 2)}"
        errors += f", worst slice {percent(report['worst_slice_transmission']['error'])}"
    fit = preferences.fit_of(result.basis)
    return f"{errors}, {report['closures']} closures, {fit}, {result.quality}, {seconds:.2f} s"


def facts(result):
    """The last bake as JSON; None before the first. Errors that the bake did not measure are None."""
    if not result.stack_hash:
        return None
    report = result.report
    return {
        "stack_hash": result.stack_hash,
        "lamina": result.version or None,
        "quality": result.quality,
        "basis": preferences.fit_of(result.basis),
        "closures": report.get("closures"),
        "errors": {
            "fit_error": report.get("fit_error"),
            "worst_slice": _within(report, "worst_slice", "error"),
            "fit_error_transmission": report.get("fit_error_transmission"),
            "worst_slice_transmission": _within(report, "worst_slice_transmission", "error"),
            "between_rows": _within(report, "tau_error", "mean"),
            "albedo_error": report.get("albedo_error"),
            "energy_error": report.get("energy_error"),
        },
    }


def _within(report, entry, name):
    return (report.get(entry) or {}).get(name)

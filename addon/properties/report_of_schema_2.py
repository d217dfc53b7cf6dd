# SPDX-License-Identifier: GPL-3.0-or-later
"""From schema 2 to 3: the numbers of a bake's report, which were single properties, become its JSON."""

import json


def gather(material):
    """Fill the report of the material's last bake from the numbers of schema 2, where it has them."""
    old = _stored(material)
    if "fit_error" not in old:
        return
    rows = json.loads(old.get("row_errors") or "[]")
    tau, mean, most = zip(*rows, strict=True) if rows else ((), (), ())
    below = {"lambert": "base_matte", "metal": "base_metal", "unknown": "base_unknown", "color": "base_color"}
    over = _group(old, {"mean": "input_mean", "worst": "input_worst", "albedo": "input_albedo"})
    report = {
        "fit_error": old["fit_error"],
        "fit_error_transmission": _measured(old, "fit_error_transmission"),
        "worst_slice": _worst(old, ""),
        "worst_slice_transmission": _worst(old, "through_"),
        "tau_rows": max(1, len(rows)),
        "row_errors": {"tau": tau, "mean": mean, "worst": most} if rows else None,
        "tau_error": _group(old, {"mean": "between_rows", "worst": "between_rows_worst"}),
        "albedo_error": old.get("albedo_error", 0.0),
        "input_error": over,
        "base_error": _group(old, below),
        "energy_error": old.get("energy_error", 0.0),
        "closures": old.get("closures", 0),
        "seconds": old.get("seconds", 0.0),
    }
    if over:
        report["input_error"] = over | {name: {"error": over[name]} for name in ("worst", "albedo")}
    material.lamina.result.report_json = json.dumps(report)


def _measured(old, name):
    """A number; None where it was not measured."""
    value = old.get(name, -1.0)
    return None if value < 0.0 else value


def _group(old, names):
    """{name: number} from {name: property}; None where the first was not measured."""
    if _measured(old, next(iter(names.values()))) is None:
        return None
    return {name: old.get(one, 0.0) for name, one in names.items()}


def _worst(old, prefix):
    """The entry of a worst slice."""
    if _measured(old, f"{prefix}worst_error") is None:
        return None
    return {
        "error": old[f"{prefix}worst_error"],
        "mu_o": min(max(old.get(f"{prefix}worst_mu", 1.0), 0.0), 1.0),
        "channel": min(max(old.get(f"{prefix}worst_channel", 0), 0), 2),
        "side": old.get(f"{prefix}worst_side", "top"),
        "tau": _measured(old, f"{prefix}worst_tau"),
    }


def _stored(material):
    """The stored values of the result, also of properties that are not registered any more."""
    # Blender 5 keeps registered properties apart from custom ones.
    properties = getattr(material, "bl_system_properties_get", lambda: material)()
    for name in ("lamina", "result"):
        properties = (properties or {}).get(name)
    return properties or {}

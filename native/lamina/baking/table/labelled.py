# SPDX-License-Identifier: GPL-3.0-or-later
"""A lookup table as an xarray.Dataset: arrays with named axes and units."""

from __future__ import annotations

import numpy as np

from ...closures.axes import column_angles
from ...common.extras import require
from ...solver.labelled import CHANNELS, channel_names


def dataset(header: dict, weights: np.ndarray):
    """See Lut.to_xarray."""
    xarray = require("xarray", "to_xarray")
    axes, report = header["axes"], header["report"]
    roughness = axes.get("roughness", {}).get("values", [0.0])
    tau = axes["tau"]["values"] or [0.0]
    azimuth = axes.get("azimuth")
    turns = azimuth["tangent"] + np.linspace(0.0, np.pi, azimuth["count"]) if azimuth else [0.0]
    angles = column_angles()
    sides, closures, _, columns, _ = weights.shape
    turned = {"azimuth": len(turns)} if azimuth else {}
    shape = (sides, closures, len(roughness), *turned.values(), len(tau), columns, 3)
    names = ("side", "closure", "roughness", *turned, "tau", "view_angle", "color")
    about = {"units": "1", "long_name": "weight of a closure"}
    found: dict[str, tuple] = {"weights": (names, weights.reshape(shape), about)}
    for kind in ("", "_transmission"):
        errors = report.get(f"slice_errors{kind}")
        if errors is not None:
            # Of a table with an axis of roughness, the errors are those at the base's own roughness
            own = {"roughness": 1} if len(roughness) == 1 else {}
            solved = {"solved_azimuth": -1} if azimuth else {}  # half of them, if the others mirror these
            array = np.array(errors)
            array = array.reshape(sides, *own.values(), *solved.values(), len(tau), array.shape[2], columns)
            found[f"slice_errors{kind}"] = (("side", *own, *solved, "tau", "channel", "view_angle"), array, {
                "units": "1", "long_name": "relative L2 error of a slice over solid angle"})
    coordinates = {
        "side": ("side", header["sides"], {"long_name": "side of the viewer"}),
        "closure": ("closure", header["closures"]),
        "roughness": ("roughness", roughness, {"units": "1", "long_name": "roughness of a Principled base"}),
        "tau": ("tau", tau, {"units": "1", "long_name": "optical thickness of the varying layer"}),
        "view_angle": ("view_angle", angles, {"units": "rad", "long_name": "angle of the view with the normal"}),
        "mu_o": ("view_angle", np.cos(angles), {"units": "1", "long_name": "cosine of the view with the normal"}),
        "color": ("color", list(CHANNELS)),
    }
    if azimuth:
        coordinates["azimuth"] = ("azimuth", turns, {"units": "rad", "long_name": "azimuth of the view"})
    if "slice_errors" in found:
        coordinates["channel"] = ("channel", channel_names(found["slice_errors"][1].shape[-2]))
    attributes = {"stack_hash": header["stack_hash"], "quality": header["quality"],
                  "basis": header.get("basis", "standard"), "fit_error": report["fit_error"]}
    return xarray.Dataset(found, coordinates, attributes)

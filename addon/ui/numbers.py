# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of the last bake in words."""

import math

from ..base import preferences
from ..base.messages import percent
from ..nodes import thickness

CHANNELS = ("red", "green", "blue")
NOTICED = 0.1  # errors above this share are told beside the state of the bake
SHOWN_ROWS = 5


def warning(result):
    """A sentence on an error that is visible in pictures, or ''."""
    report = result.report
    fit = max(one.get("fit_error", 0.0) for one in (report, report.get("uncovered", {})))
    if fit > NOTICED:
        return f"Cycles' closures miss the exact function by {percent(fit)} on average"
    errors = report.get("base_error") or {}
    worst = max((errors[name] for name in ("lambert", "metal") if name in errors), default=0.0)
    if worst > NOTICED:
        return f"The shader below is shown approximately: its energy may be wrong by {percent(worst)}"
    return ""


def below_lines(result):
    """(name, value) of the lines on a base that another shader renders, whose light is approximate."""
    errors = result.report.get("base_error")
    if not errors:
        return []
    return [
        ("Shader Below", "Approximate. Error of the energy:"),
        ("If Matte", percent(errors["lambert"])),
        ("If Rough Metal", percent(errors["metal"])),
        ("In One Channel", percent(errors["color"])),
        ("Without Reflectance", percent(errors["unknown"])),
    ]


def result_lines(result):
    """(name, value) for each of the result's numbers."""
    report = result.report
    if not report:  # of an earlier version, in a linked file
        return [("Numbers", "Update: an earlier Lamina made this bake")]
    lines = []
    for name, ending in (("Fit Error", ""), ("Transmission", "_transmission")):
        mean, worst = report[f"fit_error{ending}"], report.get(f"worst_slice{ending}")
        if mean is not None:
            text = f"{percent(mean)} mean"
            lines.append((name, f"{text}, {percent(worst['error'])} worst" if worst else text))
        if worst:
            lines.append(("Worst At", _place(worst, report["tau_rows"] > 1)))
    bare = report.get("uncovered")
    if bare:
        errors = percent(bare["fit_error"]), percent(bare["worst_slice"]["error"])
        lines.append(("Without the Film", f"{errors[0]} mean, {errors[1]} worst"))
    lines.append(("Albedo Error", percent(report["albedo_error"], 2)))
    inputs = report.get("input_error")
    if inputs:
        errors = percent(inputs["mean"]), percent(inputs["worst"]["error"])
        lines.append(("Over All Inputs", f"{errors[0]} mean, {errors[1]} worst"))
        lines.append(("Their Albedo Error", percent(inputs["albedo"]["error"], 2)))
    if report.get("faded"):
        lines.append(("Faded into Gamut", percent(report["faded"])))
    lines.append(("Energy Error", percent(report["energy_error"], 2)))
    lines.append(("Closures", f"{report['closures']}, {preferences.fit_of(result.basis)} fit"))
    lines.append(("Baked", f"{result.quality.capitalize()}, {report['seconds']:.2f} s"))
    return lines


def thickness_lines(material):
    """(name, value) of the fit error by thickness: at the value, or at some rows; and between rows."""
    report = material.lamina.result.report
    if not report.get("row_errors"):
        return []
    rows = list(zip(*(report["row_errors"][name] for name in ("tau", "mean", "worst")), strict=True))
    now = thickness.wiring(material)
    if now.source == "value":
        tau = now.socket.default_value
        rows = [min(rows, key=lambda row: abs(row[0] - tau))]
    else:
        last = len(rows) - 1
        rows = [rows[round(last * k / (SHOWN_ROWS - 1))] for k in range(SHOWN_ROWS)]
    lines = []
    for tau, mean, worst in rows:
        lines.append((f"Error at {tau:.2g}", f"{percent(mean)} mean, {percent(worst)} worst"))
    between = report.get("tau_error")
    if between:
        text = f"{percent(between['mean'], 2)} mean, {percent(between['worst'])} worst"
        lines.append(("Between Rows", text))
    return lines


def _place(worst, varies):
    """The place of a worst slice; its thickness if a layer varies."""
    angle = math.degrees(math.acos(worst["mu_o"]))
    place = [f"{angle:.0f}° view", CHANNELS[worst["channel"]]]
    if worst["side"] == "bottom":
        place.append("back side")
    if varies:
        place.append(f"thickness {worst['tau']:.2g}")
    return ", ".join(place)

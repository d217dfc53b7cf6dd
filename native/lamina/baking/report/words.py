# SPDX-License-Identifier: GPL-3.0-or-later
"""A lookup table's report in words, for terminals and logs."""

from __future__ import annotations

import math


def describe(lut) -> str:
    """Some lines of text on a Lut: the stack, the closures, and the accuracy of the fit."""
    report, header = lut.report, lut.header
    solver = report["solver"]
    lines = [
        f"stack         {header['stack_hash'][:16]}, {len(header['stack']['layers'])} layer(s)",
        f"baked by      Lamina {header.get('version', 'of a version that it does not name')}",
        f"quality       {header['quality']}, {solver['nodes']} nodes per hemisphere, {solver['orders']} azimuth orders",
        f"basis         {header.get('basis', 'standard')}, {report['closures']} fitted",
        f"closures      {', '.join(header['closures'])}",
        f"fit error     {report['fit_error']:.2%} mean, {_worst(report['worst_slice'])}",
    ]
    if report["fit_error_transmission"] is not None:
        through = report.get("worst_slice_transmission")  # not in tables of earlier versions
        lines.append(f"transmission  {report['fit_error_transmission']:.2%} mean" + (f", {_worst(through)}" if through
                                                                                   else " fit error"))
    if report.get("strayed_light"):
        strayed = report["strayed_light"]
        lines.append(f"strayed light {strayed['share']:.2%} of a view at most; a white sky in Cycles shows "
                     f"{strayed['furnace_error']:.2%} too much or too little at most")
    lines.append(f"albedo error  {report['albedo_error']:.1e} worst")
    if report.get("input_error"):
        over = report["input_error"]
        lines.append(f"with inputs   {over['mean']:.2%} mean, {over['worst']['error']:.2%} worst "
                     f"({_values(over['worst'])}); albedo error {over['albedo']['error']:.2%} worst "
                     f"({_values(over['albedo'])})")
    lines.append(f"energy error  {report['energy_error']:.1e}")
    if report["tau_rows"] > 1:
        lines.append(f"thickness     {report['tau_rows']} rows up to {header['axes']['tau']['values'][-1]:g}")
        lines += _by_thickness(report)
    if lut.uncovered is not None:
        lines += ["without the film of the varying interface:", describe(lut.uncovered)]
    return "\n".join(lines)


def _worst(worst: dict) -> str:
    angle = math.degrees(math.acos(worst["mu_o"]))
    thickness = "" if worst["tau"] is None else f", thickness {worst['tau']:.3g}"
    return f"{worst['error']:.2%} worst ({angle:.0f} degrees, channel {worst['channel']}, {worst['side']}{thickness})"


def _values(worst: dict) -> str:
    """The values of the base's inputs where an error is largest."""
    return ", ".join(f"{name} {worst[name]:g}" for name in ("color", "metallic", "roughness") if name in worst)


def _by_thickness(report: dict) -> list[str]:
    """Fit error by row, and interpolation error between rows; both are missing in tables of earlier versions."""
    lines = []
    if "row_errors" in report:
        rows = list(zip(*(report["row_errors"][key] for key in ("tau", "mean", "worst")), strict=True))
        lines += [f"  at {tau:<9.4g} {mean:.2%} mean, {worst:.2%} worst" for tau, mean, worst in rows]
    if report.get("tau_error"):
        between = report["tau_error"]
        angle = math.degrees(math.acos(between["worst_at"]["mu_o"]))
        lines.append(f"between rows  {between['mean']:.2%} mean, {between['worst']:.2%} worst ({angle:.0f} degrees, "
                     f"thickness {between['worst_at']['tau']:.3g}), mirrored light {between['mirror']:.2%} worst")
    return lines

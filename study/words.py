# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of docs/study.md and docs/study-3d.md, written from the CSV files, so that text and data agree."""

import math
import re
import statistics
from pathlib import Path

import tables
from grid import GS
from hard import NODES, SAMPLES
from walks import BASELINE, GUIDED, METHODS, chosen

Z_LIMIT_LEVEL = 0.01  # family-wise


def write_tables(docs: Path) -> None:
    """Fills the places `<!-- table:NAME -->` of pages with available data."""
    for page, makers_of in PAGES.items():
        path = docs / page
        text = path.read_text(encoding="utf-8")
        for data, makers in makers_of.items():
            if not (docs / "study" / f"{data}.csv").exists():
                continue
            rows = tables.read(data, docs / "study")
            for name, make in makers.items():
                pattern = rf"(<!-- table:{name} -->\n).*?(<!-- end -->)"
                table = make(rows)
                text, count = re.subn(pattern, lambda m, t=table: m[1] + t + "\n" + m[2], text, flags=re.DOTALL)
                if count != 1:
                    raise ValueError(f"{path}: {count} places for the table {name}: must be 1")
        path.write_text(text, encoding="utf-8")


def markdown(head, lines) -> str:
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
                     + ["| " + " | ".join(cells) + " |" for cells in lines])


def number(value) -> str:
    """Two significant digits, three above 100."""
    return f"{value:.3g}" if value >= 100 else f"{value:.2g}"


def by_cell(rows, method) -> dict:
    """Measured rows of a method, by cell."""
    return {(row["albedo"], row["tau"], row["g"], row["directions"]): row for row in rows
            if row["method"] == method and row["ratio"] is not None}


def chosen_by_cell(rows) -> dict:
    """Measured rows of the walk that `method="scattering"` chooses, by cell."""
    return {cell: row for method in {chosen(g) for g in GS} for cell, row in by_cell(rows, method).items()
            if method == chosen(cell[2])}


def _spread(ratios) -> list[str]:
    if not ratios:
        return ["0", "-", "-", "-", "-"]
    below = sum(ratio < 1.0 for ratio in ratios)
    return [str(len(ratios)), number(min(ratios)), number(statistics.median(ratios)), number(max(ratios)), str(below)]


HEAD = ["cells", "least", "median", "most", "below 1"]


def efficiency(rows) -> str:
    """Every method against the plain transfer walk, by g."""
    lines = []
    for g in GS:
        for method in [method for method in reversed(METHODS) if method != BASELINE]:
            found = [row for row in by_cell(rows, method).values() if row["g"] == g]
            if found:
                unsure = sum(row["status"] != "ok" for row in found)
                lines.append([f"{g:g}", method, *_spread([row["ratio"] for row in found]), str(unsure)])
    return markdown(["g", "walk", *HEAD, "not reliable"], lines)


def albedos(rows) -> str:
    """Our walk by g and albedo, also with all set-up included."""
    ours = chosen_by_cell(rows).values()
    lines = []
    for g in GS:
        for albedo in sorted({row["albedo"] for row in ours}):
            found = [row for row in ours if (row["g"], row["albedo"]) == (g, albedo)]
            if found:
                lines.append([f"{g:g}", f"{albedo:g}", *_spread([row["ratio"] for row in found]),
                              number(min(row["time_ratio"] for row in found)),
                              number(statistics.median(row["time_ratio"] for row in found))])
    return markdown(["g", "albedo", *HEAD, "to .1 %: least", "to .1 %: median"], lines)


def rivals(rows) -> str:
    """Our walk against the other good walks, cell by cell."""
    ours = chosen_by_cell(rows)
    lines = []
    for g in GS:
        for method in (GUIDED, "transfer"):
            if method == chosen(g):
                continue
            theirs = by_cell(rows, method)
            ratios = [ours[cell]["ratio"] / theirs[cell]["ratio"] for cell in theirs if cell in ours and cell[2] == g]
            if ratios:
                lines.append([f"{g:g}", method, *_spread(ratios)])
    return markdown(["g", "ours over", *HEAD], lines)


def losses(rows) -> str:
    """Cells where our walk is below .9 of the plain transfer walk."""
    found = sorted((row for row in chosen_by_cell(rows).values() if row["ratio"] < 0.9), key=lambda row: row["ratio"])
    lines = [[f"{row['albedo']:g}", f"{row['tau']:g}", f"{row['g']:g}", row["directions"], row["method"],
              f"{number(row['ratio'])} ± {number(row['ratio'] * row['ratio_error'])}", row["status"]] for row in found]
    return markdown(["albedo", "tau", "g", "directions", "walk", "ratio", "variance"], lines) if lines else \
        "No cell is below .9."


def promises(rows) -> str:
    """Required and measured efficiencies."""
    ours = list(chosen_by_cell(rows).values())
    asked = [
        ("g 0: least", 1.5, [r["ratio"] for r in ours if r["g"] == 0], min),
        ("g 0: median", 30.0, [r["ratio"] for r in ours if r["g"] == 0], statistics.median),
        ("g .8, albedo up to .9: least", 1.0, [r["ratio"] for r in ours if r["g"] == 0.8 and r["albedo"] <= 0.9], min),
        ("g .8, albedo up to .9: median", 10.0, [r["ratio"] for r in ours if r["g"] == 0.8 and r["albedo"] <= 0.9],
         statistics.median),
        ("g .8, all albedos: median", 10.0, [r["ratio"] for r in ours if r["g"] == 0.8], statistics.median),
        ("all cells: least", 0.9, [r["ratio"] for r in ours], min),
        ("all cells: least, to .1 % with set-up", 0.9, [r["time_ratio"] for r in ours], min),
    ]
    lines = []
    for what, limit, values, pick in asked:
        if values:
            found = pick(values)
            lines.append([what, number(limit), number(found), "yes" if found >= limit else "**no**"])
    return markdown(["efficiency over the plain transfer walk", "asked", "measured", "reached"], lines)


def setups(rows) -> str:
    lines = []
    for g in GS:
        setup = [row["setup_ms"] for row in chosen_by_cell(rows).values() if row["g"] == g]
        if setup:
            lines.append([f"{g:g}", chosen(g),
                          f"{number(min(setup))} / {number(statistics.median(setup))} / {number(max(setup))} ms"])
    return markdown(["g", "walk", "set-up: least / median / most"], lines)


def bias(rows) -> str:
    """Z-scores by method; those with an unreliable variance separately."""
    lines = []
    for method in METHODS:
        for reliable in (True, False):
            scores = [row["z"] for row in rows if row["method"] == method and row["z"] is not None
                      and (row["status"] == "ok") == reliable]
            if scores:
                limit = statistics.NormalDist().inv_cdf(1.0 - 0.5 * (1.0 - (1.0 - Z_LIMIT_LEVEL) ** (1 / len(scores))))
                rms = statistics.fmean(z * z for z in scores) ** 0.5
                lines.append([method, "reliable" if reliable else "not reliable", str(len(scores)), f"{rms:.2f}",
                              f"{max(scores, key=abs):+.2f}", f"{limit:.2f}"])
    return markdown(["walk", "variance", "cells", "root mean square of Z", "largest Z", "limit at 1 %"], lines)


def stacks(rows) -> str:
    lines = []
    for name in dict.fromkeys(row["stack"] for row in rows):
        inside = [row for row in rows if row["stack"] == name]
        adding = [row for row in inside if row["method"] == "adding" and row["ratio"] is not None]
        best = {row["directions"]: row["ratio"] for row in inside if row["method"] == "transfer"}
        if not adding:
            continue
        ratios = [row["ratio"] for row in adding]
        lines.append([name, f"{number(min(ratios))} / {number(statistics.median(ratios))} / {number(max(ratios))}",
                      number(statistics.median(row["ratio"] / best[row["directions"]] for row in adding)),
                      number(statistics.median(row["time_ratio"] for row in adding)),
                      f"{statistics.median(row['setup_ms'] for row in adding):.0f} ms",
                      f"{max(row['table_error'] for row in adding):.1e}",
                      str(sum(row["status"] != "ok" for row in adding)),
                      f"{max((row['z'] for row in adding), key=abs):+.1f}"])
    head = ["stack", "over plain transfer: least / median / most", "over the best transfer: median",
            "to .1 % with set-up: median", "set-up", "error of its tables", "not reliable", "largest Z"]
    return markdown(head, lines)


def hard_cases(rows) -> str:
    lines = [[row["case"], row["method"], f"{row['samples']:.3g}", f"{row['difference']:+.1e}",
              f"{row['standard_error']:.1e}", f"{row['solver_error']:.0e}",
              f"{row['table_error']:.0e}" if row["table_error"] else "-", f"{row['z']:+.2f}",
              number(row["largest_weight"]), f"{row['cpu_seconds']:.0f} s"] for row in rows]
    nodes = f"solver's error, {NODES[1]} against {NODES[0]} nodes"
    asked = f"samples (asked: {SAMPLES:.0e})"
    return markdown(["case", "walk", asked, "walk over solver - 1", "standard error", nodes,
                     "tables' error", "Z", "largest weight", "CPU time"], lines)


def beams(rows) -> str:
    """Cost and relative standard deviation of a sample."""
    lines = []
    for stack, method in dict.fromkeys((row["stack"], row["method"]) for row in rows):
        inside = {row["quantity"]: row for row in rows if row["stack"] == stack and row["method"] == method}
        first = inside["flux"]
        lines.append([stack, method, number(first["cpu_us"]), number(first["events"]),
                      *(_sigma(inside[quantity]) for quantity in QUANTITIES),
                      f"{max((row['z'] for row in inside.values()), key=abs):+.1f}"])
    return markdown(["stack", "walk", "µs a sample", "events", *QUANTITIES, "largest Z"], lines)


def _sigma(row) -> str:
    return number(math.sqrt(row["variance"])) + ("" if row["status"] == "ok" else " (not reliable)")


def beam_ratios(rows) -> str:
    lines = []
    for stack in dict.fromkeys(row["stack"] for row in rows if row["method"] == "scattering"):
        inside = {row["quantity"]: row for row in rows if row["stack"] == stack and row["method"] == "scattering"}
        lines.append([stack, *(f"{number(inside[q]['ratio'])} ± {number(inside[q]['ratio'] * inside[q]['ratio_error'])}"
                               for q in QUANTITIES)])
    return markdown(["stack", *QUANTITIES], lines)


QUANTITIES = ("flux", "flux within 1 mm", "at 1/mm", "mean distance")
PAGES = {
    "study.md": {
        "grid": {"promises": promises, "efficiency": efficiency, "albedos": albedos, "rivals": rivals,
                 "losses": losses, "setups": setups, "bias": bias},
        "layers": {"stacks": stacks},
        "hard": {"hard": hard_cases},
    },
    "study-3d.md": {"lateral": {"beams": beams, "beam-ratios": beam_ratios}},
}

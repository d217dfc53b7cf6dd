# SPDX-License-Identifier: GPL-3.0-or-later
"""The closure fit over the published list of stacks, tests/data/fit_stacks.json."""

import json
import statistics
from pathlib import Path

import lamina

STACKS = Path(__file__).resolve().parent.parent / "tests/data/fit_stacks.json"


def load():
    """(id, Stack) of the list, in order."""
    entries = json.loads(STACKS.read_text(encoding="utf-8"))
    return [(entry.pop("id"), lamina.Stack.from_json(entry)) for entry in entries]


def measure():
    """A row for each stack, and one that sums them up, per quality."""
    rows = []
    for quality in ("preview", "final"):
        reports = [(name, lamina.bake(stack, quality).report) for name, stack in load()]
        for name, report in reports:
            through = report["fit_error_transmission"]
            rows.append({"stack": name, "quality": quality, "mean": report["fit_error"],
                         "worst": report["worst_slice"]["error"], "albedo": report["albedo_error"],
                         "transmission": through, "closures": report["closures"]})
        some = [row for row in rows if row["quality"] == quality]
        rows.append({"stack": f"all {len(some)}", "quality": quality,
                     "mean": statistics.fmean(row["mean"] for row in some),
                     "worst": max(row["worst"] for row in some), "albedo": max(row["albedo"] for row in some),
                     "transmission": _mean([row["transmission"] for row in some]),
                     "closures": statistics.fmean(row["closures"] for row in some)})
    return rows


def _mean(values):
    known = [value for value in values if value is not None]
    return statistics.fmean(known) if known else None

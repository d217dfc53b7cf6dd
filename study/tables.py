# SPDX-License-Identifier: GPL-3.0-or-later
"""The study's data as CSV files under docs/study, one row per measurement."""

import csv
import os
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "docs/study"


def write(name: str, rows: list[dict], folder: Path = DATA) -> Path:
    """The file is written completely or not at all. Numbers are rounded to five digits, values to ten."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.csv"
    fresh = path.with_suffix(".new")
    keys = list(dict.fromkeys(key for row in rows for key in row))
    with fresh.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, keys, lineterminator="\n", restval="")
        writer.writeheader()
        writer.writerows({key: _text(key, value) for key, value in row.items()} for row in rows)
    os.replace(fresh, path)
    return path


def read(name: str, folder: Path = DATA) -> list[dict]:
    """Rows as written, with numbers converted; None for missing measurements."""
    with (folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return [{key: _value(text) for key, text in row.items()} for row in csv.DictReader(file)]


def _text(key: str, value) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.10g}" if key in ("value", "truth") else f"{value:.5g}"
    return str(value)


def _value(text: str):
    if text == "":
        return None
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text

# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements from a CSV file, whose first line names its columns with their units."""

from __future__ import annotations

import csv
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..common.errors import ArgumentError, MeasurementError, clipped, quoted, similar
from .measurements import DIFFUSE, Brdf, Btdf, Measurement, Profile, Reflectance, Transmittance

# Columns of places: the argument that they give, and how.
PLACES = {"mu_o": ("mu_o", "mu"), "mu_i": ("mu_i", "mu"), "r_mm": ("r", "mm")}
PLACES |= {f"theta_{side}_{unit}": (f"mu_{side}", unit) for side in "oi" for unit in ("deg", "rad")}
PLACES |= {f"dphi_{unit}": ("dphi", unit) for unit in ("deg", "rad")}
# Columns of values: the measurement, its arguments, and those that need a column.
KINDS: dict[str, tuple[type[Measurement], dict, tuple[str, ...]]] = {
    "brdf": (Brdf, {}, ("mu_o", "mu_i", "dphi")),
    "btdf": (Btdf, {}, ("mu_o", "mu_i", "dphi")),
    "reflectance": (Reflectance, {"mu_i": DIFFUSE}, ()),
    "transmittance": (Transmittance, {"mu_i": DIFFUSE}, ()),
    "reflected_per_mm2": (Profile, {"path": "reflect"}, ("r",)),
    "transmitted_per_mm2": (Profile, {"path": "transmit"}, ("r",)),
}
ERRORS = ("sigma", "relative")
# Channels with these names have this sequence; others that of their columns.
SEQUENCE = ("red", "r", "green", "g", "blue", "b")


@dataclass(frozen=True)
class Column:
    """What a column of values holds: `error` is "sigma", "relative" or "" for the values themselves."""

    kind: str
    channel: str
    error: str


def read_csv(path: str | os.PathLike, **common) -> list[Measurement]:
    """One measurement for each kind of value in the file; `common`: arguments of all of them. Raises MeasurementError,
    ArgumentError and OSError."""
    header, rows = _table(path)
    places: dict[str, np.ndarray] = {}
    for at, name in enumerate(header):
        if name in PLACES:
            argument = PLACES[name][0]
            if argument in places:
                raise MeasurementError(f"{path}: {name}: an earlier column gives the same, in another unit")
            places[argument] = _place(path, name, rows[:, at])
    columns = {at: _column(path, name) for at, name in enumerate(header) if name not in PLACES}
    kinds = list(dict.fromkeys(column.kind for column in columns.values() if column.kind))
    if not kinds:
        raise MeasurementError(f"{path}: no column of values: must have one of {', '.join(KINDS)}")
    return [_measurement(path, kind, columns, places, rows, common) for kind in kinds]


def _measurement(path, kind: str, columns: dict[int, Column], places: dict[str, np.ndarray], rows: np.ndarray,
                 common: dict) -> Measurement:
    made, usual, needed = KINDS[kind]
    for place in needed:
        if place not in places:
            names = " or ".join(name for name, (argument, _) in PLACES.items() if argument == place)
            raise MeasurementError(f"{path}: a column of {kind} needs a column {names}")
    own = [at for at, column in columns.items() if column.kind == kind and not column.error]
    if all(columns[at].channel in SEQUENCE for at in own):
        own.sort(key=lambda at: SEQUENCE.index(columns[at].channel))
    given = dict(common)
    for error in ERRORS:
        found = [_errors(columns, rows, error, kind, columns[at].channel) for at in own]
        known = [one for one in found if one is not None]
        if len(known) == len(found):
            given[error] = np.stack(known, axis=-1)
        elif known:
            raise MeasurementError(f"{path}: only some columns of {kind} have a column {error}")
    wanted = (*needed, "mu_i") if kind not in ("brdf", "btdf") else needed
    here = {name: places[name] for name in wanted if name in places}
    values = rows[:, own]
    if made is Profile and "mu_i" in here:
        if np.ptp(here["mu_i"]) > 0.0:
            raise MeasurementError(f"{path}: the angle of the beam differs between lines: must be one in a file")
        here["mu_i"] = here["mu_i"][0]
    if not here:  # diffuse light: one measurement has no places
        if len(rows) > 1:
            raise MeasurementError(f"{path}: {len(rows)} lines of {kind} without an angle: must be one line of diffuse "
                                   "light, or have a column mu_i, theta_i_deg or theta_i_rad")
        values = values[0]
        given |= {error: given[error][0] for error in ERRORS if isinstance(given.get(error), np.ndarray)}
    try:
        return made(values=values, **{**usual, **here}, **given)
    except ArgumentError as error:
        raise MeasurementError(f"{path}: {kind}: {error}") from None


def _errors(columns: dict[int, Column], rows: np.ndarray, error: str, kind: str, channel: str) -> np.ndarray | None:
    """The column of standard errors of one channel: its own, that of the kind, or that of the line."""
    for key in ((kind, channel), (kind, ""), ("", "")):
        for at, column in columns.items():
            if column.error == error and (column.kind, column.channel) == key:
                return rows[:, at]
    return None


def _table(path) -> tuple[list[str], np.ndarray]:
    """(names of the columns, numbers [line, column])."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise MeasurementError(f"{path}: must be a text of comma-separated values") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1)
             if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) < 2:
        raise MeasurementError(f"{path}: must have a line with the names of columns, and lines of numbers")
    try:
        (_, header), *data = [(number, [cell.strip() for cell in next(csv.reader([line]))]) for number, line in lines]
    except csv.Error as error:
        raise MeasurementError(f"{path}: must be a text of comma-separated values: {error}") from None
    twice = [name for name in header if header.count(name) > 1]
    if twice:
        raise MeasurementError(f"{path}: two columns are called {quoted(twice[0])}")
    rows = np.empty((len(data), len(header)))
    for index, (number, cells) in enumerate(data):
        if len(cells) != len(header):
            raise MeasurementError(f"{path}: line {number} has {len(cells)} entries: must have {len(header)}, one for "
                                   "each column")
        for at, cell in enumerate(cells):
            try:
                rows[index, at] = float(cell)
            except ValueError:
                rows[index, at] = math.nan
            if not math.isfinite(rows[index, at]):
                raise MeasurementError(f"{path}: line {number}, {header[at]} = {quoted(clipped(cell))}: must be a "
                                       "finite number")
    return header, rows


def _column(path, name: str) -> Column:
    """What a column of this name holds. Raises MeasurementError."""
    match = re.fullmatch(rf"(?:({'|'.join(ERRORS)})_?)?(?:({'|'.join(KINDS)})(?:_(\w+))?)?", name)
    if not name or match is None or (match[1] and name == f"{match[1]}_"):
        known = [*PLACES, *KINDS, *ERRORS]
        nearest = similar(name, known, 0.5)
        meant = f"; similar ones are {', '.join(nearest)}" if nearest else f"; known are {', '.join(known)}"
        raise MeasurementError(f"{path}: column {quoted(name)} is unknown{meant}")
    return Column(match[2] or "", match[3] or "", match[1] or "")


def _place(path, name: str, values: np.ndarray) -> np.ndarray:
    """A column of places as an argument: cosines, radians or mm. Raises MeasurementError if the unit is doubtful."""
    argument, unit = PLACES[name]
    radians = name.replace("_deg", "_rad")
    if unit == "deg":
        few = 2.0 * math.pi if argument == "dphi" else 0.5 * math.pi
        if len(np.unique(values)) > 3 and np.abs(values).max() <= few:
            raise MeasurementError(f"{path}: {name} holds no angle above {np.abs(values).max():.3g}: are these "
                                   f"radians? then call the column {radians}")
        values = np.radians(values)
    if argument in ("mu_o", "mu_i") and unit != "mu":
        outside = (values < 0.0) | (values >= 0.5 * math.pi)
        if np.any(outside):
            wrong = values[outside][0] if unit == "rad" else math.degrees(values[outside][0])
            limit = "pi / 2; are these degrees? then call the column " + name.replace("_rad", "_deg")
            raise MeasurementError(f"{path}: {name} = {wrong:g}: must lie in [0, {'90' if unit == 'deg' else limit}"
                                   f"{')' if unit == 'deg' else ''}")
        return np.cos(values)
    if argument == "dphi" and unit == "rad" and np.abs(values).max() > 2.0 * math.pi + 1e-6:
        raise MeasurementError(f"{path}: {name} = {values[np.abs(values).argmax()]:g}: must lie in [-2 pi, 2 pi]; are "
                               "these degrees? then call the column dphi_deg")
    return values

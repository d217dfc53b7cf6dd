# SPDX-License-Identifier: GPL-3.0-or-later
"""Checked arguments of functions: whole numbers, choices, directions, callables. Quantities of a stack: see fields."""

from __future__ import annotations

import math
import numbers
import operator
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from ..kinds.fields import Field
from ..kinds.limits import MOST_SEED, MOST_THREADS, SEED, THREADS
from .errors import ArgumentError, quoted

# At this cosine, BRDFs equal their limit at grazing incidence to nine digits. Below 1e-150 the square of a cosine
# underflows.
LEAST_COSINE = 1e-9
LEAST_BEAM_COSINE = 1e-4  # of pencil beams: light of flatter beams leaves too far away for tables and photons


def check_whole(value, name: str, low: int, high: int, rule: str = "") -> int:
    """`value` as an int in [low, high]; `rule` replaces the words of the error for that range. Raises ArgumentError."""
    if isinstance(value, numbers.Integral) and not isinstance(value, bool) and low <= int(value) <= high:
        return operator.index(value)
    raise ArgumentError(f"{name} = {quoted(value)}: {rule or f'must be a whole number from {low} to {high}'}")


def check_choice(value, name: str, choices: Iterable[str], words: str = "") -> str:
    """`value` if it is one of the choices; `words` replaces their list in the error. Raises ArgumentError."""
    if isinstance(value, str) and value in choices:
        return value
    raise ArgumentError(f"{name} = {quoted(value)}: must be {words or 'one of ' + ', '.join(choices)}")


def check_number(value, name: str, rule: str, fits) -> float:
    """`value` as a float, if it is one finite number and `fits(value)` is true. Raises ArgumentError, which ends with
    `rule`."""
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if math.isfinite(number) and fits(number):
            return number
    raise ArgumentError(f"{name} = {quoted(value)}: {rule}")


def check_field(value, field: Field) -> float:
    """`value` as the one number of a Field, which gives its name and range: an int where the field is whole. Raises
    ArgumentError."""
    if field.whole:
        return check_whole(value, field.name, int(field.low), int(field.high), field.rule)
    return check_number(value, field.name, field.rule, field.contains)


def check_kind(value, name: str, kind: type, words: str):
    """`value` if it is an instance of `kind`, which `words` describes in the error. Raises ArgumentError."""
    if isinstance(value, kind):
        return value
    raise ArgumentError(f"{name} = {quoted(value)}: must be {words}")


def check_flag(value, name: str) -> bool:
    """`value` as a bool. Raises ArgumentError unless it is True or False."""
    if isinstance(value, bool | np.bool_):
        return bool(value)
    raise ArgumentError(f"{name} = {quoted(value)}: must be True or False")


def check_callable(value, name: str) -> None:
    """Raises ArgumentError unless `value` can be called or is None."""
    if value is not None and not callable(value):
        raise ArgumentError(f"{name} = {quoted(value)}: must be a function or None")


def check_path(path) -> Path:
    """The path of a file. Raises ArgumentError unless it is a text or a path that can name one."""
    try:
        text = os.fsdecode(path)
    except TypeError:
        raise ArgumentError(f"path = {quoted(path)}: must be a string or a Path") from None
    if not text or "\0" in text:
        raise ArgumentError(f"path = {quoted(text)}: must name a file")
    return Path(text)


def check_threads(threads: int) -> int:
    """A count of threads, 0 for all. Raises ArgumentError."""
    return check_whole(threads, "threads", 0, MOST_THREADS, THREADS)


def check_seed(seed: int) -> int:
    """A seed. Raises ArgumentError."""
    return check_whole(seed, "seed", 0, MOST_SEED, SEED)


def finite_array(values, name: str) -> np.ndarray:
    """The values as an array of floats of any shape. Raises ArgumentError."""
    if np.ma.is_masked(values):
        raise ArgumentError(f"{name} holds masked values: leave these out")
    try:
        array = np.asarray(values)
        if array.dtype.kind == "c":  # NumPy would drop imaginary parts
            raise TypeError
        array = array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{name} = {quoted(values)}: must be a number or an array of numbers") from None
    if not np.all(np.isfinite(array)):
        raise ArgumentError(f"{name} holds a value that is not finite")
    return array


def finite_list(values, name: str) -> np.ndarray:
    """The values as an array of shape (count,), also of a single value. Raises ArgumentError."""
    array = np.atleast_1d(finite_array(values, name))
    if array.ndim != 1:
        raise ArgumentError(f"{name} has the shape {array.shape}: must be a number or a list of numbers")
    return array


def cosines(values: np.ndarray, name: str) -> np.ndarray:
    """Cosines in (0, 1]; those below LEAST_COSINE become LEAST_COSINE. `values`: an array from finite_array. Raises
    ArgumentError."""
    outside = (values <= 0.0) | (values > 1.0)
    if np.any(outside):
        raise ArgumentError(f"{name} = {values[outside].flat[0]:g}: must lie in (0, 1]")
    return np.maximum(values, LEAST_COSINE)


def broadcast(arrays: Sequence[np.ndarray], names: Sequence[str]) -> list[np.ndarray]:
    """The arrays in their common shape. Raises ArgumentError when there is none."""
    try:
        return np.broadcast_arrays(*arrays)
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(names, arrays, strict=True))
        raise ArgumentError(f"{shapes}: shapes must be equal or broadcast") from None

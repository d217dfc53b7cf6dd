# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates in parts that different machines may run. Each part holds sums, squares and counts; merging adds them."""

from __future__ import annotations

import json
import math
import numbers
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from ..common import json_file
from ..common.arguments import check_kind, check_seed, check_whole
from ..common.atomic import write_atomically
from ..common.errors import ArgumentError, ShardError, clipped, quoted
from ..common.progress import Progress, stepper
from ..material.stack import Stack
from ..solver.solve import check_stack, thread_pool
from .estimate import BLOCK, CHUNK, Estimate, Query, blocks_of, chunks_in, run_channels, run_chunks, summary

SCHEMA = 1
_KEYS = {"schema", "job", "shard", "table_error", "channels"}
_JOB = {"stack", "mu_o", "mu_i", "dphi", "side", "path", "method", "blocks", "seed"}
MOST_PARTS = 1 << 20


def run_shard(stack: Stack, query: Query, method: str, samples: int, seed: int, shard: tuple[int, int],
              progress: Progress | None = None, cancel: Callable[[], bool] | None = None, threads: int = 0) -> dict:
    """Part i of n, `shard` = (i, n) with i from 1, of an estimate with that many samples, as a plain object for
    json.dump. It holds no times: the same part has the same bytes on any machine. Raises as estimate does."""
    check_stack(stack)
    check_kind(query, "query", Query, "a lamina.Query")
    number, count = _checked_shard(shard)
    blocks = blocks_of(samples)
    check_seed(seed)
    pool = thread_pool(threads)
    chunks = chunks_in(blocks)
    first, last = (number - 1) * chunks // count, number * chunks // count
    step = stepper("the estimate", progress, cancel)
    channels, error = run_channels(stack, query, method, pool, step, lambda walk, within: [
        list(tally) for tally in run_chunks(walk, seed, first, last, blocks, pool, within)])
    job = {"stack": stack.hash, **asdict(query), "method": method, "blocks": blocks, "seed": seed}
    return {"schema": SCHEMA, "job": job, "shard": [number, count], "table_error": error, "channels": channels}


def save_part(part: dict, path: str | os.PathLike) -> None:
    """Writes a part; the file appears whole or not at all."""
    write_atomically(path, lambda file: file.write((json.dumps(part) + "\n").encode()))


def load_part(path: str | os.PathLike) -> dict:
    """Reads a part. Raises ShardError, with the file's name, and OSError."""
    try:
        part = json_file.parse(Path(path).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ShardError(f"{path}: not a JSON file ({error})") from None
    _check_part(part, str(path))
    return part


def merge(parts: Sequence[dict], names: Sequence[str] | None = None) -> Estimate:
    """The estimate of all parts of a job, in any order; `seconds` is not known (NaN). Parts and names go together.
    Raises ShardError if parts are missing, given twice, damaged, or of different jobs."""
    if not isinstance(parts, Sequence) or isinstance(parts, str) or not parts:
        raise ShardError(f"parts = {quoted(parts)}: must be a list of at least one part")
    names = [f"parts[{k}]" for k in range(len(parts))] if names is None else names
    if not isinstance(names, Sequence) or len(names) != len(parts):
        raise ShardError(f"names = {quoted(names)}: must be a list of {len(parts)} names, one a part")
    for part, name in zip(parts, names, strict=True):
        _check_part(part, name)
        _check_together(part, name, parts[0], names[0])
    by_number: dict = {}
    count = parts[0]["shard"][1]
    for part, name in zip(parts, names, strict=True):
        number = part["shard"][0]
        if number in by_number:
            raise ShardError(f"{name}: part {number} of {count} is given twice")
        by_number[number] = part
    missing = [str(number) for number in range(1, count + 1) if number not in by_number]
    if missing:
        raise ShardError(f"part {clipped(', '.join(missing))} of {count} is missing")
    ordered = [by_number[number] for number in range(1, count + 1)]
    channels = [[tally for part in ordered for tally in part["channels"][c]] for c in range(len(parts[0]["channels"]))]
    return summary(channels, math.nan, max(part["table_error"] for part in ordered))


def _checked_shard(shard: tuple[int, int]) -> tuple[int, int]:
    if not isinstance(shard, tuple | list) or len(shard) != 2:
        raise ArgumentError(f"shard = {quoted(shard)}: must be a pair (i, n)")
    try:
        count = check_whole(shard[1], "n", 1, MOST_PARTS)
        return check_whole(shard[0], "i", 1, count), count
    except ArgumentError:
        where = "/".join(map(quoted, shard))
        raise ArgumentError(f"shard = {where}: must be i/n with 1 <= i <= n <= 2^20") from None


def _check_part(part, name: str) -> None:
    """Raises ShardError unless it is a whole part of an estimate."""
    if not isinstance(part, dict) or set(part) != _KEYS:
        raise ShardError(f"{name}: not a part of an estimate")
    if not isinstance(part["schema"], int) or part["schema"] != SCHEMA:
        raise ShardError(f"{name}: schema = {quoted(part['schema'])}: must be {SCHEMA}")
    if not isinstance(part["job"], dict) or set(part["job"]) != _JOB:
        raise ShardError(f"{name}: not a whole part of an estimate")
    for key, value in part["job"].items():
        if value is not None and not isinstance(value, str) and not _is_finite(value):
            raise ShardError(f"{name}: job.{key} = {quoted(value)}: must be a text or a finite number")
    try:
        number, count = _checked_shard(part["shard"])
        blocks = check_whole(part["job"]["blocks"], "job.blocks", 1, blocks_of(None, 0.5))
    except ArgumentError as error:
        raise ShardError(f"{name}: {error}") from None
    if not _is_finite(part["table_error"]) or part["table_error"] < 0.0:
        raise ShardError(f"{name}: table_error = {quoted(part['table_error'])}: must be a number from 0")
    channels, chunks = part["channels"], chunks_in(blocks)
    first, last = (number - 1) * chunks // count, number * chunks // count
    if not isinstance(channels, list) or not channels:
        raise ShardError(f"{name}: channels = {quoted(channels)}: must be a list of at least one channel")
    for index, tallies in enumerate(channels):
        if not isinstance(tallies, list) or len(tallies) != last - first:
            raise ShardError(f"{name}: channels[{index}]: must be a list of {last - first} tallies")
        for chunk, tally in enumerate(tallies, first):
            _check_tally(tally, BLOCK * (min((chunk + 1) * CHUNK, blocks) - chunk * CHUNK),
                         f"{name}: channels[{index}][{chunk - first}]")


def _check_tally(tally, samples: int, path: str) -> None:
    """Raises ShardError unless it is the (sum, squares, largest, count, events) of that many samples."""
    if not isinstance(tally, list) or len(tally) != 5 or not all(map(_is_finite, tally)):
        raise ShardError(f"{path} = {quoted(tally)}: must be five finite numbers")
    _, squares, _, count, events = tally
    if squares < 0.0:
        raise ShardError(f"{path}[1] = {squares:g}: a sum of squares must not be negative")
    if count != samples:
        raise ShardError(f"{path}[3] = {quoted(count)}: must be {samples}, the number of samples")
    if not isinstance(events, int) or events < 0:
        raise ShardError(f"{path}[4] = {quoted(events)}: must be a whole number of events from 0")


def _check_together(part: dict, name: str, first: dict, first_name: str) -> None:
    """Raises ShardError unless both are parts of one job."""
    for key, value in first["job"].items():
        if part["job"][key] != value:
            raise ShardError(f"{name}: {key} = {quoted(part['job'][key])} but {first_name} has {quoted(value)}: parts "
                             "of different jobs cannot be merged")
    number, of = part["shard"]
    if of != first["shard"][1]:
        raise ShardError(f"{name}: part {number} of {of}, but {first_name} is one of {first['shard'][1]}")
    if len(part["channels"]) != len(first["channels"]):
        raise ShardError(f"{name} has {len(part['channels'])} channels: must have {len(first['channels'])} like "
                         f"{first_name}")


def _is_finite(value) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and abs(value) <= 1e300  # type: ignore[operator]  # numbers.Real

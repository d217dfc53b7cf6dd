# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates in parts that any machines may run: each part holds sums, squares and counts, merging adds them."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from . import _core
from .atomic import write_atomically
from .errors import ShardError
from .estimate import (
    Estimate,
    Query,
    blocks_of,
    check_seed,
    chunks_in,
    run_channels,
    run_chunks,
    summary,
)
from .progress import Progress, stepper
from .solve import thread_pool
from .stack import Stack

SCHEMA = 1
_KEYS = {"schema", "job", "shard", "table_error", "channels"}


def run_shard(stack: Stack, query: Query, method: str, samples: int, seed: int, shard: tuple[int, int],
              progress: Progress | None = None, cancel: Callable[[], bool] | None = None, threads: int = 0) -> dict:
    """Part i of n, `shard` = (i, n) with i from 1, of an estimate with that many samples, as a plain object for
    json.dump. It holds no times: the same part is the same bytes, whoever runs it. Raises as estimate does."""
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
        part = json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ShardError(f"{path}: not a JSON file ({error})") from None
    if not isinstance(part, dict) or set(part) != _KEYS:
        raise ShardError(f"{path}: not a part of an estimate")
    if part["schema"] != SCHEMA:
        raise ShardError(f"{path}: schema = {part['schema']!r}: must be {SCHEMA}")
    if not _is_whole(part):
        raise ShardError(f"{path}: not a whole part of an estimate")
    return part


def merge(parts: Sequence[dict], names: Sequence[str] | None = None) -> Estimate:
    """The estimate of all parts of a job, in any sequence; `seconds` is not known (NaN). Parts and names go
    together. Raises ShardError when parts are missing, twice there, or of different jobs."""
    if not parts:
        raise ShardError("parts = []: must hold at least one")
    names = list(names) if names is not None else [f"parts[{k}]" for k in range(len(parts))]
    by_number: dict = {}
    count = parts[0]["shard"][1]
    for part, name in zip(parts, names, strict=True):
        for key, value in parts[0]["job"].items():
            if part["job"].get(key) != value:
                raise ShardError(f"{name}: {key} = {part['job'].get(key)!r} but {names[0]} has {value!r}: parts of "
                                 "different jobs cannot be merged")
        number, of = part["shard"]
        if of != count:
            raise ShardError(f"{name}: part {number} of {of}, but {names[0]} is one of {count}")
        if number in by_number:
            raise ShardError(f"{name}: part {number} of {count} is given twice")
        by_number[number] = part
    missing = [str(number) for number in range(1, count + 1) if number not in by_number]
    if missing:
        raise ShardError(f"part {', '.join(missing)} of {count} is missing")
    ordered = [by_number[number] for number in range(1, count + 1)]
    channels = [[tally for part in ordered for tally in part["channels"][c]] for c in range(len(parts[0]["channels"]))]
    return summary(channels, math.nan, max(part["table_error"] for part in ordered))


def _checked_shard(shard: tuple[int, int]) -> tuple[int, int]:
    number, count = shard
    if not 1 <= count <= 1 << 20 or not 1 <= number <= count:
        raise ValueError(f"shard = {number}/{count}: must be i/n with 1 <= i <= n <= 2^20")
    return number, count


def _is_whole(part: dict) -> bool:
    """Whether a part has all chunks that its job and number say."""
    try:
        number, count = _checked_shard(part["shard"])
        blocks = part["job"]["blocks"]
        chunks = chunks_in(blocks)
        wanted = number * chunks // count - (number - 1) * chunks // count
        return (isinstance(part["table_error"], float) and len(part["channels"]) > 0
                and all(len(channel) == wanted for channel in part["channels"])
                and all(len(tally) == 5 and all(isinstance(x, int | float) for x in tally)
                        for channel in part["channels"] for tally in channel))
    except (TypeError, KeyError, ValueError):
        return False

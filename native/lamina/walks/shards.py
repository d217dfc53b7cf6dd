# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates in parts that different machines may run. Each part holds sums, squares and counts; merging adds them."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict

from ..common import json_file
from ..common.arguments import check_kind, check_path
from ..common.atomic import write_atomically
from ..common.errors import ShardError, quoted
from ..common.parts import in_sequence
from ..common.progress import Progress, stepper
from ..material.any_stack import AnyStack, as_stack
from .estimate import Estimate, Query, run_channels, run_chunks, summary
from .estimate_searchlight import SearchlightEstimate
from .searchlight_shards import SEARCHLIGHT
from .shard_parts import SCHEMA, PartKind, check_part, is_finite, prepared


def run_shard(stack: AnyStack, query: Query, method: str, samples: int, seed: int, shard: tuple[int, int],
              progress: Progress | None = None, cancel: Callable[[], bool] | None = None, *, threads: int = 0) -> dict:
    """Part i of n, `shard` = (i, n) with i from 1, of an estimate with `samples` samples, as a plain object for
    json.dump. It holds no times: the same part has the same bytes on any machine. Raises as estimate does."""
    check_kind(query, "query", Query, "a lamina.Query")
    stack = as_stack(stack)
    stack.require_isotropic("an estimate in parts")
    blocks, chunks, pool = prepared(samples, seed, shard, threads)
    step = stepper("the estimate", progress, cancel)
    channels, error = run_channels(stack, query, method, pool, step, lambda walk, within: [
        list(tally) for tally in run_chunks(walk, seed, chunks.start, chunks.stop, blocks, pool, within)])
    asked = {name: value for name, value in asdict(query).items() if name != "phi_o"}
    job = {"stack": stack.hash, **asked, "method": method, "blocks": blocks, "seed": seed}
    return {"schema": SCHEMA, "job": job, "shard": list(map(int, shard)), "table_error": error, "channels": channels}


def save_part(part: dict, path: str | os.PathLike) -> None:
    """Writes a part, completely or not at all. Raises ShardError for what is no part, and OSError."""
    check_part(part, "part", KINDS)
    write_atomically(path, lambda file: file.write((json.dumps(part) + "\n").encode()))


def load_part(path: str | os.PathLike) -> dict:
    """Reads a part. Raises ShardError, with the file's name, and OSError."""
    path = check_path(path)
    try:
        part = json_file.parse(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ShardError(f"{path}: not a JSON file ({error})") from None
    check_part(part, str(path), KINDS)
    return part


def merge(parts: Sequence[dict], names: Sequence[str] | None = None) -> Estimate | SearchlightEstimate:
    """The estimate of all parts of a job, in any order; `seconds` is not known (NaN). Parts and names go together.
    Raises ShardError if parts are missing, given twice, damaged, or of different jobs."""
    if not isinstance(parts, Sequence) or isinstance(parts, str) or not parts:
        raise ShardError(f"parts = {quoted(parts)}: must be a list of at least one part")
    names = [f"parts[{k}]" for k in range(len(parts))] if names is None else names
    if not isinstance(names, Sequence) or len(names) != len(parts):
        raise ShardError(f"names = {quoted(names)}: must be a list of {len(parts)} names, one per part")
    kinds = [check_part(part, name, KINDS) for part, name in zip(parts, names, strict=True)]
    order = in_sequence([part["job"] for part in parts], [part["shard"] for part in parts], names)
    channels = len(parts[0]["channels"])
    for part, name in zip(parts, names, strict=True):
        if len(part["channels"]) != channels:
            raise ShardError(f"{name} has {len(part['channels'])} channels: must have {channels} like {names[0]}")
    return kinds[0].summary([parts[place] for place in order])


def _check_table_error(part: dict, name: str) -> None:
    if not is_finite(part["table_error"]) or part["table_error"] < 0.0:
        raise ShardError(f"{name}: table_error = {quoted(part['table_error'])}: must be a number from 0")


def _check_tally(tally, _part: dict, path: str) -> None:
    """Raises ShardError unless it is (sum, squares, largest, count, events)."""
    if not isinstance(tally, list) or len(tally) != 5 or not all(map(is_finite, tally)):
        raise ShardError(f"{path} = {quoted(tally)}: must be five finite numbers")
    if tally[1] < 0.0:
        raise ShardError(f"{path}[1] = {tally[1]:g}: a sum of squares must not be negative")


def _summary(parts: list[dict]) -> Estimate:
    channels = [[tally for part in parts for tally in part["channels"][c]] for c in range(len(parts[0]["channels"]))]
    return summary(channels, math.nan, max(part["table_error"] for part in parts))


ESTIMATE = PartKind(
    frozenset({"table_error"}),
    frozenset({"stack", "mu_o", "mu_i", "dphi", "side", "path", "method", "blocks", "seed"}),
    _check_table_error, lambda channel, _: channel, _check_tally, _summary)
KINDS = (ESTIMATE, SEARCHLIGHT)

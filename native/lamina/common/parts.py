# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in parts: computed one after another or by any executor of concurrent.futures, and put together again.

A part is a pure function of its arguments, so the results do not depend on who computes it."""

from __future__ import annotations

import concurrent.futures
from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import Executor
from typing import Any

from .arguments import check_whole
from .errors import ArgumentError, ShardError, clipped, quoted
from .progress import Progress, portion

MOST_SHARDS = 1 << 20
POLL = 0.2  # seconds between two calls of `cancel`


def each_part(call: Callable, parts: Sequence[Hashable], step: Progress, executor: Executor | None = None,
              keep: Callable[[Any, Any], None] | None = None, work: Callable[[Any], float] = lambda _: 1.0) -> list:
    """The results of `call(part, step)` for all `parts`, in their sequence. With an executor, `call(part)` runs there;
    an executor with a method `ready(step)` is called before. `keep(part, result)` is called as soon as a result is
    there. `work`: of a part, for the progress. Raises what a call raises, and Cancelled."""
    total, done, found = sum(map(work, parts)), 0.0, {}

    def kept(part: Hashable, result: Any) -> None:
        nonlocal done
        found[part] = result
        done += work(part)
        if keep is not None:
            keep(part, result)

    if executor is None:
        for part in parts:
            kept(part, call(part, portion(step, done / total, (done + work(part)) / total)))
        return list(found.values())
    if hasattr(executor, "ready"):
        executor.ready(step)
    step(0.0, f"0 of {len(parts)} parts")
    futures = {executor.submit(call, part): part for part in parts}
    waiting = set(futures)
    try:
        while waiting:
            finished, waiting = concurrent.futures.wait(waiting, POLL, concurrent.futures.FIRST_COMPLETED)
            for future in finished:
                kept(futures[future], future.result())
            step(done / total, f"{len(found)} of {len(parts)} parts")
        return [found[part] for part in parts]
    finally:
        for future in waiting:
            future.cancel()


def checked_shard(shard: tuple[int, int]) -> tuple[int, int]:
    """(i, n) with 1 <= i <= n. Raises ArgumentError."""
    if not isinstance(shard, tuple | list) or len(shard) != 2:
        raise ArgumentError(f"shard = {quoted(shard)}: must be a pair (i, n)")
    try:
        count = check_whole(shard[1], "n", 1, MOST_SHARDS)
        return check_whole(shard[0], "i", 1, count), count
    except ArgumentError:
        where = "/".join(map(quoted, shard))
        raise ArgumentError(f"shard = {where}: must be i/n with 1 <= i <= n <= 2^20") from None


def shards_of(count: int) -> list[tuple[int, int]]:
    """The numbers (i, n) of `count` parts."""
    return [(number, count) for number in range(1, count + 1)]


def share_of(shard: tuple[int, int], count: int) -> range:
    """Part (i, n) of a range of `count` things."""
    number, parts = shard
    return range((number - 1) * count // parts, number * count // parts)


def in_sequence(jobs: Sequence[dict], shards: Sequence[tuple[int, int]], names: Sequence[str]) -> list[int]:
    """The indices of the parts of a run, by their numbers. `jobs`: descriptions of the run. Raises ShardError if parts
    are missing, given twice, or of different runs."""
    count, by_number = shards[0][1], {}
    for index, (job, (number, of), name) in enumerate(zip(jobs, shards, names, strict=True)):
        if set(job) != set(jobs[0]):
            raise ShardError(f"{name}: not of the kind of {names[0]}: parts of different jobs cannot be merged")
        for key, value in jobs[0].items():
            if job[key] != value:
                raise ShardError(f"{name}: {key} = {quoted(job[key])} but {quoted(value)} in {names[0]}: parts of "
                                 "different jobs cannot be merged")
        if of != count:
            raise ShardError(f"{name}: part {number} of {of}, but {names[0]} is one of {count}")
        if number in by_number:
            raise ShardError(f"{name}: part {number} of {count} is given twice")
        by_number[number] = index
    missing = [str(number) for number in range(1, count + 1) if number not in by_number]
    if missing:
        raise ShardError(f"part {clipped(', '.join(missing))} of {count} is missing")
    return [by_number[number] for number in range(1, count + 1)]

# SPDX-License-Identifier: GPL-3.0-or-later
"""The common form of all parts of split estimates: a job, the part's number, and the sums of its chunks."""

from __future__ import annotations

import numbers
from collections.abc import Callable
from dataclasses import dataclass

from .. import _core
from ..common.arguments import check_seed, check_whole
from ..common.errors import ArgumentError, ShardError, quoted
from ..common.parts import checked_shard, share_of
from ..solver.core_calls import thread_pool
from .estimate import BLOCK, CHUNK, MOST_SAMPLES, blocks_of, chunks_in

SCHEMA = 1


@dataclass(frozen=True)
class PartKind:
    """One kind of estimate that can be split. A part is an object with `keys` beside schema, job, shard and channels;
    its job has the entries `job`. `check_rest(part, name)` checks entries that only this kind has.
    `tallies(channel, path)` are those of one entry of `channels`, whose other entries it checks, and
    `check_tally(tally, part, path)` checks one of them, which ends with the numbers of samples and events. These raise
    ShardError. `summary(parts)` is the estimate from all parts in order."""

    keys: frozenset[str]
    job: frozenset[str]
    check_rest: Callable
    tallies: Callable
    check_tally: Callable
    summary: Callable

    def fits(self, part) -> bool:
        """True if it looks like a part of this kind; without its job it may be a damaged one."""
        return isinstance(part, dict) and set(part) == {"schema", "job", "shard", "channels", *self.keys}


def prepared(samples: int, seed: int, shard: tuple[int, int], threads: int) -> tuple[int, range, _core.ThreadPool]:
    """(the blocks of the entire run, the chunks of the part, threads). Raises ArgumentError."""
    shard = checked_shard(shard)
    blocks = blocks_of(samples)
    check_seed(seed)
    return blocks, share_of(shard, chunks_in(blocks)), thread_pool(threads)


def check_part(part, name: str, kinds: tuple[PartKind, ...]) -> PartKind:
    """The kind of a part. Raises ShardError unless the part is complete."""
    kind = next((kind for kind in kinds if kind.fits(part)), None)
    if kind is None:
        raise ShardError(f"{name}: not a part of an estimate")
    if not isinstance(part["schema"], int) or part["schema"] != SCHEMA:
        raise ShardError(f"{name}: schema = {quoted(part['schema'])}: must be {SCHEMA}")
    if not isinstance(part["job"], dict) or set(part["job"]) != kind.job:
        raise ShardError(f"{name}: not a complete part of an estimate")
    for key, value in part["job"].items():
        plain = all(map(is_finite, value)) if isinstance(value, list) else is_finite(value)
        if value is not None and not isinstance(value, str) and not plain:
            raise ShardError(f"{name}: job.{key} = {quoted(value)}: must be a text or a finite number")
    try:
        shard = checked_shard(part["shard"])
        blocks = check_whole(part["job"]["blocks"], "job.blocks", 1, -(-MOST_SAMPLES // BLOCK))
    except ArgumentError as error:
        raise ShardError(f"{name}: {error}") from None
    kind.check_rest(part, name)
    samples = [BLOCK * (min((chunk + 1) * CHUNK, blocks) - chunk * CHUNK)
               for chunk in share_of(shard, chunks_in(blocks))]
    if not isinstance(part["channels"], list) or not part["channels"]:
        raise ShardError(f"{name}: channels = {quoted(part['channels'])}: must be a list of at least one channel")
    for index, channel in enumerate(part["channels"]):
        path = f"{name}: channels[{index}]"
        tallies = kind.tallies(channel, path)
        if not isinstance(tallies, list) or len(tallies) != len(samples):
            raise ShardError(f"{path}: must be a list of {len(samples)} tallies")
        for place, (tally, wanted) in enumerate(zip(tallies, samples, strict=True)):
            kind.check_tally(tally, part, f"{path}[{place}]")
            _check_counts(tally, wanted, f"{path}[{place}]")
    return kind


def _check_counts(tally: list, samples: int, path: str) -> None:
    """Raises ShardError unless a tally ends with the number of `samples`, and with a number of events."""
    *_, count, events = tally
    if count != samples:
        raise ShardError(f"{path}[{len(tally) - 2}] = {quoted(count)}: must be {samples}, the number of samples")
    if not isinstance(events, int) or isinstance(events, bool) or events < 0:
        raise ShardError(f"{path}[{len(tally) - 1}] = {quoted(events)}: must be a whole number of events from 0")


def is_finite(value) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and abs(value) <= 1e300  # type: ignore[operator]  # numbers.Real

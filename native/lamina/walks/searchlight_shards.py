# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates of searchlights in parts that different machines may run; shards.merge adds them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict

from ..common.arguments import check_kind
from ..common.errors import ArgumentError, ShardError, quoted
from ..common.progress import Progress, stepper
from ..material.any_stack import AnyStack, as_stack
from ..material.millimetres import lengths_hash
from .estimate_searchlight import SearchlightEstimate, SearchlightQuery, run_beams, summary
from .shard_parts import SCHEMA, PartKind, is_finite, prepared


def run_searchlight_shard(stack: AnyStack, query: SearchlightQuery, samples: int, seed: int, shard: tuple[int, int],
                          progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
                          threads: int = 0) -> dict:
    """Part i of n, `shard` = (i, n) with i from 1, of a searchlight's estimate with `samples` samples, as a plain
    object for json.dump. It holds no times: the same part has the same bytes on any machine. Raises as
    estimate_searchlight does."""
    check_kind(query, "query", SearchlightQuery, "a lamina.SearchlightQuery")
    stack = as_stack(stack)
    blocks, chunks, pool = prepared(samples, seed, shard, threads)
    step = stepper("the estimate", progress, cancel)
    channels = run_beams(stack, query, seed, chunks, blocks, pool, step)
    for channel in channels:
        channel["tallies"] = [[list(above), list(below), count, events]
                              for above, below, count, events in channel["tallies"]]
    job = {"stack": lengths_hash(stack), **asdict(query), "blocks": blocks, "seed": seed}
    job["r"], job["q"] = list(query.r), list(query.q)
    return {"schema": SCHEMA, "job": job, "shard": list(map(int, shard)), "beam": "searchlight", "channels": channels}


def _query(part: dict, name: str) -> SearchlightQuery:
    job = part["job"]
    try:
        return SearchlightQuery(job["mu_i"], job["walk"], job["r"], job["q"])
    except ArgumentError as error:
        raise ShardError(f"{name}: job.{error}") from None


def _check_rest(part: dict, name: str) -> None:
    if part["beam"] != "searchlight":
        raise ShardError(f"{name}: beam = {quoted(part['beam'])}: must be 'searchlight'")
    _query(part, name)


def _tallies(channel, path: str):
    if not isinstance(channel, dict) or set(channel) != {"mirrored", "unscattered", "endless", "tallies"}:
        raise ShardError(f"{path}: not a complete channel of a searchlight")
    for name in ("mirrored", "unscattered"):
        if not is_finite(channel[name]) or not 0.0 <= channel[name] <= 1.0 + 1e-9:
            raise ShardError(f"{path}.{name} = {quoted(channel[name])}: must lie in [0, 1]")
    if not isinstance(channel["endless"], bool):
        raise ShardError(f"{path}.endless = {quoted(channel['endless'])}: must be true or false")
    return channel["tallies"]


def _check_tally(tally, part: dict, path: str) -> None:
    query = _query(part, path)
    scores = 3 + len(query.q)
    sizes = [len(query.radii)] * 2 + [scores, scores * (scores + 1) // 2]
    if not isinstance(tally, list) or len(tally) != 4:
        raise ShardError(f"{path} = {quoted(tally)}: must be two sides and two counts")
    for side in tally[:2]:
        whole = isinstance(side, list) and [len(s) if isinstance(s, list) else -1 for s in side] == sizes
        if not whole or not all(is_finite(number) for sums in side for number in sums):
            raise ShardError(f"{path}: must be lists of {sizes} finite numbers on each side")


def _summary(parts: list[dict]) -> SearchlightEstimate:
    channels = []
    for entries in zip(*(part["channels"] for part in parts), strict=True):
        tallies = [tally for entry in entries for tally in entry["tallies"]]
        channels.append({**entries[0], "tallies": tallies})
    return summary(_query(parts[0], "parts[0]"), channels, math.nan)


SEARCHLIGHT = PartKind(frozenset({"beam"}),
                       frozenset({"stack", "mu_i", "walk", "r", "q", "blocks", "seed"}),
                       _check_rest, _tallies, _check_tally, _summary)

# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder with the finished parts of a run. An interrupted run continues at the parts that are missing."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..common import json_file
from ..common.atomic import write_atomically
from ..common.errors import ArgumentError, ShardError
from ..common.progress import Progress, portion, time_left
from ..interior.parts import WalkPart

FORMAT, SCHEMA = "lamina-run", 1
MOST_PARTS = 4096
SAMPLES_PER_PART = 1 << 15  # about a second of work without lamps

LEAST_SECONDS = 1.0  # of work, on which an estimate of the remaining time is based


@dataclass(frozen=True)
class Pilot:
    """Earlier work of the same kind: `seconds` of it, and its `work`, in samples per point of the run. `aim`: what the
    run is for, in words."""

    seconds: float = 0.0
    work: float = 0.0
    aim: str = ""


# compute(description of the run, parts that are missing, function that keeps a part, progress)
Compute = Callable[[dict, list[tuple[int, int]], Callable[[WalkPart], None], Progress], None]


class PartFolder:
    """The parts of one run in a folder, or in memory only if `path` is None.

    The file run.json holds the request, which identifies the run, and the number of samples. A folder with the
    run.json of another request is refused. Files of other names are left alone, except temporary files of parts, which
    a killed run may leave behind. Raises ArgumentError, ShardError, OSError."""

    def __init__(self, path: str | os.PathLike | None, request: dict):
        if path is not None and not isinstance(path, str | os.PathLike):
            raise ArgumentError(f"folder = {path!r}: must be a path or None")
        self._path = None if path is None else Path(path)
        self._request = json.loads(json.dumps(request))
        self.samples: int | None = None
        """Walks per point of an earlier start of this run, or None."""
        if self._path is None:
            return
        self._path.mkdir(parents=True, exist_ok=True)
        found = _read(self._path / "run.json")
        if found is None:
            return
        for key in sorted({*self._request, *found["request"]}):
            if found["request"].get(key) != self._request.get(key):
                raise ShardError(f"{self._path} holds the parts of another run, with a different {key}: choose another "
                                 "folder, or delete this one")
        self.samples = found["samples"]
        for left in self._path.glob(".part-*-of-*.npz.*.part"):
            left.unlink(missing_ok=True)

    def begin(self, samples: int) -> None:
        """Note the number of samples of a new run."""
        if self._path is not None and self.samples is None:
            header = {"format": FORMAT, "schema": SCHEMA, "request": self._request, "samples": samples}
            text, path = json.dumps(header, indent=1, sort_keys=True) + "\n", self._path / "run.json"
            self._kept(lambda: write_atomically(path, lambda file: file.write(text.encode())), 0)

    def run(self, passes: Sequence[dict], compute: Compute, step: Progress,
            passed: Callable[[list[list[WalkPart]]], None], pilot: Pilot | None = None) -> list[list[WalkPart]]:
        """All parts of each pass, in sequence: read from the folder where they are whole, otherwise computed and
        written. `passes`: the descriptions that the parts must have, which differ in their samples. Calls
        `passed(parts so far)` after each pass except the last. `pilot`: with it the first report of progress already
        tells the time."""
        plan = [(place, shard) for place, job in enumerate(passes) for shard in _shards(job)]
        numbers = {one: number for number, one in enumerate(plan, start=1)}
        found = {one: self._load(passes[one[0]], one[1], number, len(plan)) for one, number in numbers.items()}
        whole = {one: part for one, part in found.items() if part is not None}
        work = {(place, shard): passes[place]["samples"] / shard[1] for place, shard in plan}
        total, pilot = sum(work.values()), pilot or Pilot()
        before, began = sum(work[one] for one in whole), time.perf_counter()

        def told(fraction: float, _text: str) -> None:
            text = f"Part {min(len(whole) + 1, len(plan))} of {len(plan)}"
            walked = fraction * total - before + pilot.work
            seconds = time.perf_counter() - began + pilot.seconds
            if walked > 0.0 and (pilot.work or seconds >= LEAST_SECONDS):
                text += f", {time_left(seconds / walked * (1.0 - fraction) * total)}{pilot.aim}"
            step(fraction, text)

        for place, job in enumerate(passes):
            shards = [shard for where, shard in plan if where == place]
            missing = [shard for shard in shards if (place, shard) not in whole]

            def keep(part: WalkPart, place: int = place) -> None:
                one = place, part.shard
                self._save(part, numbers[one], len(plan), len(whole))
                whole[one] = part

            if missing:
                done = sum(work[one] for one in whole)
                compute(job, missing, keep, portion(told, done / total, (done + sum(
                    work[place, shard] for shard in missing)) / total))
            if place + 1 < len(passes):
                passed([[whole[one] for one in plan if one[0] == earlier] for earlier in range(place + 1)])
        return [[whole[one] for one in plan if one[0] == place] for place in range(len(passes))]

    def _load(self, job: dict, shard: tuple[int, int], number: int, count: int) -> WalkPart | None:
        """The part in the folder, or None if its file is missing, damaged or of another run."""
        if self._path is None:
            return None
        try:
            part = WalkPart.load(self._path / _name(number, count))
        except (ShardError, OSError):
            return None
        return part if part.job == job and part.shard == shard else None

    def _save(self, part: WalkPart, number: int, count: int, done: int) -> None:
        if self._path is not None:
            path = self._path / _name(number, count)
            self._kept(lambda: part.save(path), done)

    def _kept(self, write: Callable[[], None], done: int) -> None:
        """Write a file. An OSError then says what is kept."""
        try:
            write()
        except OSError as error:
            reason = error.strerror or "cannot be written"
            raise OSError(error.errno, f"{reason}; {done} finished parts are kept, and the same call continues after "
                          "them", str(self._path)) from None


def _shards(job: dict) -> list[tuple[int, int]]:
    count = max(1, min(job["count"], MOST_PARTS, -(-job["count"] * job["samples"] // SAMPLES_PER_PART)))
    return [(number, count) for number in range(1, count + 1)]


def _name(number: int, count: int) -> str:
    return f"part-{number:04d}-of-{count:04d}.npz"


def _read(path: Path) -> dict | None:
    """The header of a run, or None if the file is missing or damaged."""
    try:
        found = json_file.parse(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(found, dict) or found.get("format") != FORMAT or found.get("schema") != SCHEMA:
        return None
    samples = found.get("samples")
    whole = isinstance(samples, int) and not isinstance(samples, bool) and samples >= 1
    return found if whole and isinstance(found.get("request"), dict) else None

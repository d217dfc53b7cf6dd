# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder with the finished parts of a run. An interrupted run continues at the parts that are missing."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

from ..common import json_file
from ..common.atomic import write_atomically
from ..common.errors import ArgumentError, ShardError
from ..common.parts import each_part, shards_of
from ..common.progress import Progress, portion, time_left
from ..interior.parts import WalkPart
from ..interior.problem import SPLIT_PHOTONS, Samples

FORMAT, SCHEMA = "lamina-run", 2
MOST_PARTS = 4096
SAMPLES_PER_PART = 1 << 15  # about a second of work without lamps
LEAST_PARTS, MOST_BYTES = 8, 1 << 27  # of a pass of photons
LEAST_SECONDS = 1.0  # of work, on which an estimate of the remaining time is based


@dataclass(frozen=True)
class Pilot:
    """Earlier work of the same kind: `seconds` of it, and its `work`, in samples per point of the run. `aim`: what the
    run is for, in words."""

    seconds: float = 0.0
    work: float = 0.0
    aim: str = ""


Parts = list[list[WalkPart]]  # of each pass


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
        self.samples: tuple[int, int] | None = None
        """Walks and photons per point of an earlier start of this run, or None."""
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
        self.samples = found["samples"], found["photons"]
        for left in self._path.glob(".part-*-of-*.npz.*.part"):
            left.unlink(missing_ok=True)

    def begin(self, samples: tuple[int, int]) -> None:
        """Note the numbers of walks and photons of a new run."""
        if self._path is not None and self.samples is None:
            header = {"format": FORMAT, "schema": SCHEMA, "request": self._request, "samples": samples[0],
                      "photons": samples[1]}
            text, path = json.dumps(header, indent=1, sort_keys=True) + "\n", self._path / "run.json"
            self._kept(lambda: write_atomically(path, lambda file: file.write(text.encode())), 0)

    def run(self, call: Callable, passes: dict[Samples, dict], step: Progress, passed: Callable[[Parts], None],
            pilot: Pilot | None = None, executor: Executor | None = None) -> Parts:
        """All parts of each pass, in sequence: read from the folder where they are whole, otherwise computed by `call`
        of (samples, shard), see each_part, and written. `passes`: the descriptions that the parts must have. Calls
        `passed(parts so far)` after each pass except the last. `pilot`: with it the first report of progress already
        tells the time."""
        numbered = {(samples, shard): number for number, (samples, shard) in enumerate(
            ((samples, shard) for samples, job in passes.items() for shard in _shards(job)), start=1)}
        count, pilot, shown = len(numbered), pilot or Pilot(), 0
        read = {key: self._load(passes[key[0]], key[1], number, count) for key, number in numbered.items()}
        whole = {key: part for key, part in read.items() if part is not None}
        total, before, began = sum(map(_work, numbered)), sum(map(_work, whole)), time.perf_counter()

        def told(fraction: float, _text: str) -> None:
            text = f"Part {min(len(whole) + 1, count)} of {count}"
            walked = fraction * total - before + pilot.work
            seconds = time.perf_counter() - began + pilot.seconds
            if walked > 0.0 and (pilot.work or seconds >= LEAST_SECONDS):
                text += f", {time_left(seconds / walked * (1.0 - fraction) * total)}{pilot.aim}"
            step(fraction, text)

        def of_passes(last: int) -> Parts:
            return [[whole[key] for key in numbered if key[0] == samples] for samples in list(passes)[:last]]

        def show() -> None:
            nonlocal shown
            while shown + 1 < len(passes) and all(key in whole for key in numbered if key[0] == list(passes)[shown]):
                shown += 1
                passed(of_passes(shown))

        def keep(key: tuple[Samples, tuple[int, int]], part: WalkPart) -> None:
            self._save(part, numbered[key], count, len(whole))
            whole[key] = part
            show()

        show()
        each_part(call, [key for key in numbered if key not in whole], portion(told, before / total, 1.0), executor,
                  keep, _work)
        return of_passes(len(passes))

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
        assert self._path is not None
        try:
            try:
                write()
            except FileNotFoundError:  # another process has ended the same run, and its folder is removed
                self._path.mkdir(parents=True, exist_ok=True)
                write()
        except OSError as error:
            reason = error.strerror or "cannot be written"
            raise OSError(error.errno, f"{reason}; {done} finished parts are kept, and the same call continues after "
                          "them", str(self._path)) from None


def _shards(job: dict) -> list[tuple[int, int]]:
    most = min(job["count"], MOST_PARTS)
    if job.get("kind") == SPLIT_PHOTONS:  # each part has sums and squares, of 8 bytes and three channels, at all points
        most = min(MOST_PARTS, max(LEAST_PARTS, MOST_BYTES // (48 * job["count"] * len(job["lamps"]))))
    return shards_of(max(1, min(most, -(-job["count"] * job["samples"] // SAMPLES_PER_PART))))


def _work(part: tuple[Samples, tuple[int, int]]) -> float:
    """Samples per point of the run."""
    samples, (_, count) = part
    return samples.count * max(1, samples.lamps) / count


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
    counts = found.get("samples"), found.get("photons")
    whole = all(isinstance(one, int) and not isinstance(one, bool) and one >= 1 for one in counts)
    return found if whole and isinstance(found.get("request"), dict) else None

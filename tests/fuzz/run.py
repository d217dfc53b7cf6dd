# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves and bakes random stacks and checks invariants of all stacks. Each runs in a separate process, which reports
its CPU time and memory. A refusal in one sentence is counted and listed.

python tests/fuzz/run.py --count 3000 --seed 1 [--first 0] [--results FILE]

With --results each finding is written as a line of JSON as soon as the stack is done. Stacks that are already in the
file are skipped, so an interrupted run can be continued."""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import signal
import sys
import traceback
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # z_limit
import invariants
from random_stacks import random_stack

import lamina

MOST_SECONDS, MOST_MEGABYTES = 2.0, 400.0
KILLED_AFTER = 60  # CPU seconds
LARGEST = 6 << 30  # bytes of address space


def examine(seed: int, number: int, comparisons: int, walked: bool, baked: bool = True) -> dict:
    """The findings for one stack: `wrong`, sentences; or `refused`, one sentence; CPU seconds of solve and bake."""
    stack = random_stack(seed, number)
    chance = random.Random(f"points {seed}:{number}")
    found = {"number": number, "wrong": [], "refused": "", "solve": 0.0, "bake": 0.0}

    def refuse(error):
        text = str(error)
        if "\n" in text or len(text) > 500:
            found["wrong"].append(f"a refusal that is not one short sentence: {text[:200]!r}")
        found["refused"] = text

    try:
        started = cpu()
        solved = lamina.solve(stack, invariants.QUALITY, threads=1)
        found["solve"] = cpu() - started
        values = invariants.grids(solved)
        found["megabytes"] = peak_megabytes()
        found["wrong"] += invariants.of_values(stack, values) + invariants.of_energy(solved)
        if baked:
            started = cpu()
            table = lamina.bake(stack, invariants.QUALITY, threads=1)
            found["bake"] = cpu() - started
            found["megabytes"] = peak_megabytes()
            found["wrong"] += invariants.of_table(table)
        found["wrong"] += invariants.of_splitting(stack, values, chance)
        found["wrong"] += invariants.of_thickness(solved, chance)
        if walked:
            found["wrong"] += invariants.of_walks(solved, values, chance, comparisons)
    except (lamina.SolveError, lamina.StackError) as error:
        found["solve"] = found["solve"] or cpu() - started
        refuse(error)
    except Exception as error:
        trace = traceback.extract_tb(error.__traceback__)[-1]
        found["wrong"].append(f"{type(error).__name__}: {error} ({trace.filename}:{trace.lineno})")
    found.setdefault("megabytes", peak_megabytes())
    return found


def cpu() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def peak_megabytes() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def apart(work) -> dict:
    """Run `work` in a child process, so that crashes and endless loops are recorded as findings."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        resource.setrlimit(resource.RLIMIT_CPU, (KILLED_AFTER, KILLED_AFTER + 5))
        resource.setrlimit(resource.RLIMIT_AS, (LARGEST, LARGEST))
        try:
            with os.fdopen(writer, "w") as pipe:
                json.dump(work(), pipe)
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as pipe:
        text = pipe.read()
    _, status, usage = os.wait4(child, 0)
    if text:
        return json.loads(text)
    how = signal.Signals(os.WTERMSIG(status)).name if os.WIFSIGNALED(status) else f"exit {os.WEXITSTATUS(status)}"
    return {"wrong": [f"the process ended without a word: {how}"], "refused": "", "bake": 0.0,
            "solve": usage.ru_utime + usage.ru_stime, "megabytes": usage.ru_maxrss / 1024.0}


def read_results(path: Path | None, seed: int) -> dict[int, dict]:
    """Findings of an earlier run by number; an incomplete last line is ignored."""
    found = {}
    if path and path.exists():
        for line in path.read_text().splitlines():
            try:
                result = json.loads(line)
            except json.JSONDecodeError:
                continue
            if result["seed"] == seed:
                found[result["number"]] = result
    return found


def summary(results: list[dict]) -> str:
    """A summary of the findings, with the worst by time and by memory."""
    wrong = [r for r in results if r["wrong"]]
    refused = [r for r in results if r["refused"]]
    slow = [r for r in results if seconds(r) > MOST_SECONDS]
    large = [r for r in results if r["megabytes"] > MOST_MEGABYTES]
    lines = [f"{len(results)} stacks: {len(wrong)} wrong, {len(refused)} refused, {len(slow)} above {MOST_SECONDS:g} "
             f"CPU-s, {len(large)} above {MOST_MEGABYTES:g} MB"]
    lines += [f"  wrong {r['number']}: {text}" for r in wrong for text in r["wrong"]]
    reasons = Counter(r["refused"] for r in refused)
    numbers = {text: [r["number"] for r in refused if r["refused"] == text] for text in reasons}
    lines += [f"  refused {numbers[text][:8]}: {text}" for text in reasons]
    for name, key, unit in (("time", seconds, "CPU-s"), ("memory", lambda r: r["megabytes"], "MB")):
        worst = sorted(results, key=key, reverse=True)[:10]
        lines.append(f"  worst by {name}: " + ", ".join(f"{r['number']} {key(r):.2f}" for r in worst) + f" {unit}")
    return "\n".join(lines)


def seconds(result: dict) -> float:
    return max(result["solve"], result["bake"])


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", "--count", type=int, default=3000)
    parser.add_argument("--first", type=int, default=0, help="number of the first stack")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--walk-every", type=int, default=10, help="0: no walks")
    parser.add_argument("--no-bake", action="store_true")
    parser.add_argument("--results", type=Path, help="file of findings, one line of JSON each; a run goes on with it")
    parser.add_argument("--show", action="store_true", help="print the stacks as JSON, and what each costs")
    given = parser.parse_args(arguments)
    # Tables that all bakes share are computed once, before time is measured.
    for warm in (lamina.Stack([lamina.Medium(albedo=0.5, tau=1.0)]),
                 lamina.Stack([lamina.Interface(1.5, 0.1)], lamina.Lambert(0.5)),
                 lamina.Stack([lamina.Interface(1.5, 0.1), lamina.Interface(1.0, 0.1)])):
        lamina.bake(warm, invariants.QUALITY, threads=1)
    numbers = range(given.first, given.first + given.count)
    every = given.walk_every
    comparisons = 3 * invariants.WALK_POINTS * max(1, len(numbers) // every if every else 1)
    known = read_results(given.results, given.seed)
    results = []
    for number in numbers:
        if number in known:
            results.append(known[number])
            continue
        walked = bool(every) and number % every == 0
        result = apart(lambda number=number, walked=walked: examine(
            given.seed, number, comparisons, walked, not given.no_bake))
        result |= {"number": number, "seed": given.seed}
        results.append(result)
        if given.results:
            with given.results.open("a") as file:
                file.write(json.dumps(result) + "\n")
        if given.show:
            print(json.dumps(random_stack(given.seed, number).to_json()))
        if given.show or result["wrong"] or seconds(result) > MOST_SECONDS or result["megabytes"] > MOST_MEGABYTES:
            print(f"{number}: solve {result['solve']:.2f} s, bake {result['bake']:.2f} s, {result['megabytes']:.0f} MB "
                  f"{result['refused']} {'; '.join(result['wrong'])}", flush=True)
    print(summary(results))
    return 1 if any(r["wrong"] for r in results) else 0


if __name__ == "__main__":
    sys.exit(main())

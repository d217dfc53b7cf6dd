# SPDX-License-Identifier: GPL-3.0-or-later
"""The walks against the solver, with which they share only the description of the stack: Z-scores with fixed seeds,
family-wise level 1 %."""

import math
import random
from functools import cache

import numpy as np
import pytest
from drawn_kinds import drawn
from walk_cases import CASES, SLAB, hg, solved_value
from z_limit import z_limit

import lamina
from lamina import (
    Black,
    Conductor,
    HalfSpace,
    HenyeyGreenstein,
    Interface,
    Knot,
    Lambert,
    Medium,
    Stack,
    StackError,
)
from lamina.cli import main
from lamina.kinds import phases

SAMPLES = 1 << 16
LIMIT = z_limit(2 * len(CASES))  # both walks of all cases


@cache
def solved(stack_hash):
    return lamina.solve(next(stack for _, stack, _ in CASES if stack.hash == stack_hash), threads=1)


def z_score(stack, query, method, samples=SAMPLES, seed=1, truth=None):
    truth = solved_value(solved(stack.hash), query) if truth is None else truth
    found = lamina.estimate(stack, query.mu_o, query.mu_i, query.dphi, method, samples, seed=seed, threads=1,
                            side=query.side, path=query.path)
    # The error of the tables counts as an additional error, as does the solver's tolerance.
    return (found.value[0] - truth) / math.hypot(found.stderr[0], max(found.table_error, 1e-6) * truth)


@pytest.mark.parametrize("method", ["transfer", "adding"])
@pytest.mark.parametrize(("stack", "query"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_walk_against_solver(stack, query, method):
    assert abs(z_score(stack, query, method)) < LIMIT


HARD = [
    ("conservative and thick", Stack([hg(1.0, 50.0, 0.0)]), (0.7, 0.9, 1.0), 1 << 15),
    ("sharp forward peak", Stack([hg(0.9, 2.0, 0.9)]), (0.5, 0.5, math.pi / 2), 1 << 18),
    ("grazing", Stack([hg(0.95, 1.0, 0.5)]), (0.05, 0.05, 0.5), 1 << 16),
    ("conservative half-space", Stack([hg(1.0, math.inf, 0.0)]), (0.3, 0.8, 2.0), 1 << 14),
]


@pytest.mark.parametrize(("stack", "directions", "samples"), [case[1:] for case in HARD], ids=[c[0] for c in HARD])
def test_hard_cases(stack, directions, samples):
    truth = lamina.solve(stack, threads=1).brdf(*directions)[0]
    query = lamina.Query(*directions)
    assert abs(z_score(stack, query, "transfer", samples, truth=truth)) < LIMIT


@pytest.mark.parametrize("phase", [*(drawn(cls, random.Random(1)) for cls in phases.KINDS),
                                   lamina.Mixture([(0.7, HenyeyGreenstein(0.6)), (0.3, lamina.Rayleigh())])],
                         ids=lambda phase: phase.kind)
def test_every_kind_of_phase_function_has_a_slab_loop(phase):
    stack = Stack([Medium(albedo=0.9, tau=1.0, phase=phase)])
    truth = lamina.solve(stack, threads=1).brdf(0.6, 0.7, 1.0)[0]
    assert abs(z_score(stack, lamina.Query(0.6, 0.7, 1.0), "transfer", truth=truth)) < LIMIT


@pytest.mark.parametrize("next_event", ["at_collision", "along_flight"])
def test_simpler_next_events_estimate_the_same(next_event):
    """In the slab's own loop and, below a boundary without effect, in the loop for any stack."""
    from lamina import _core
    from lamina.solver.core_stack import core_stack
    pool = _core.ThreadPool(1)
    truth = lamina.solve(SLAB, threads=1).brdf(0.5, 0.5, math.pi / 2)[0]
    for stack in (SLAB, Stack([*SLAB.layers, Interface(1.0)])):
        _, layers, base = core_stack(stack, 0)
        walk = _core.transfer_walk(_core.Stack(layers, base), lamina.Query(0.5, 0.5, math.pi / 2).target(),
                                   getattr(_core.NextEvent, next_event))
        total, squares, _, count, _ = _core.run_walk(walk, 5, 0, 40, pool)
        mean = total / count
        error = math.sqrt((squares / count - mean**2) / count)
        assert abs(mean - truth) / error < LIMIT


@pytest.mark.parametrize("method", ["transfer", "adding"])
def test_same_numbers_for_any_threads(method):
    stack = Stack([Interface(1.5, 0.3), hg([0.9, 0.5], 1.0, 0.5)], Lambert(0.5))
    one, two = (lamina.estimate(stack, 0.5, 0.7, 1.0, method, 40000, seed=7, threads=n) for n in (1, 2))
    for name in ("value", "stderr", "samples", "events"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    assert one.samples.tolist() == [40960, 40960]
    assert one.value[0] != one.value[1]


def test_seeds_are_independent_and_errors_are_honest():
    """Over 40 seeds, the spread agrees with the standard errors."""
    found = [lamina.estimate(SLAB, 0.5, 0.5, 1.0, "transfer", 4096, seed=seed, threads=1) for seed in range(40)]
    spread = np.std([f.value[0] for f in found], ddof=1) / np.mean([f.stderr[0] for f in found])
    # The standard deviation of a sample of 40 is off by 11 %; a few heavy samples make it more.
    assert 0.6 < spread < 1.4


def test_target_error():
    found = lamina.estimate(SLAB, None, 0.5, target_error=0.01, seed=1, threads=1)
    assert found.stderr[0] <= 0.01 * found.value[0]
    assert found.samples[0] % 65536 == 0
    most = lamina.estimate(SLAB, None, 0.5, target_error=1e-6, samples=100000, seed=1, threads=1)
    assert most.samples[0] == 102400
    assert most.stderr[0] > 1e-6 * most.value[0]


def test_progress_and_cancel():
    told = []
    lamina.estimate(SLAB, 0.5, 0.5, samples=200000, threads=1, progress=lambda f, text: told.append(f))
    assert told == sorted(told) and told[0] == 0.0 and len(told) == 4
    with pytest.raises(lamina.Cancelled):
        lamina.estimate(SLAB, 0.5, 0.5, samples=1 << 30, threads=1, cancel=lambda: len(told) > 0)


def test_black_and_clear_layers():
    assert lamina.estimate(Stack([hg(0.0, 1.0, 0.0)]), 0.5, 0.5, samples=1, threads=1).value[0] == 0.0
    clear = lamina.estimate(Stack([hg(0.5, 0.0, 0.0)]), None, 0.5, path="transmit", samples=1, threads=1)
    assert clear.value[0] == 1.0


@pytest.mark.parametrize(("arguments", "words"), [
    ({"mu_i": 0.0}, "mu_i = 0.0: must be one number in"),
    ({"mu_o": 1.5}, "mu_o = 1.5: must be one number in"),
    ({"dphi": math.nan}, "dphi = nan"),
    ({"method": "guess"}, "method = 'guess': must be one of"),
    ({"samples": 0}, "samples = 0: must be a whole number"),
    ({"seed": -1}, "seed = -1"),
    ({"target_error": 0.0}, "target_error = 0.0"),
    ({"side": "left"}, "side = 'left'"),
    ({"path": "through"}, "path = 'through'"),
])
def test_bad_arguments(arguments, words):
    with pytest.raises(ValueError, match=words):
        lamina.estimate(**{"stack": SLAB, "mu_o": 0.5, "mu_i": 0.5, **arguments})


def test_light_from_below_needs_a_sheet():
    with pytest.raises(StackError, match="side = 'bottom'"):
        lamina.estimate(Stack([hg(0.5, 1.0, 0.0)], Lambert(0.5)), 0.5, 0.5, side="bottom")


@pytest.mark.parametrize("g", [0.0, 0.75])
def test_the_scattering_walk_finds_the_solved_value(g):
    stack = Stack([hg(0.9, 2.0, g)])
    found = lamina.estimate(stack, 0.5, 0.7, 1.5, method="scattering", samples=1 << 16)
    exact = lamina.solve(stack).brdf(0.5, 0.7, 1.5)
    # The solved value is good to 2e-5 of itself.
    assert np.all(np.abs(found.value - exact) < z_limit(2) * np.hypot(found.stderr, 2e-5 * exact))
    assert np.all(found.stderr < 2e-3 * exact)


def test_stacks_that_the_scattering_walk_does_not_know():
    for stack, more, words in [(Stack([Interface(1.5)], Lambert(0.5)), {}, ".* do not support boundaries"),
                               (Stack([hg(0.9, 1.0, 0.0)]), {"path": "transmit"}, "estimates only the BRDF from above"),
                               (Stack([hg(0.9, 1.0, 0.0)]), {"side": "bottom"}, "estimates only the BRDF from above")]:
        with pytest.raises(StackError, match=f"method = 'scattering': {words}"):
            lamina.estimate(stack, 0.5, 0.5, method="scattering", **more)


# Cosines, azimuth: at the end of the range of a table's error estimate, between its knots, and at peaks.
LOOKED_UP = [(0.05, 0.05, 0.5), (0.05, 0.05, 2.5), (0.053, 0.062, 0.03), (0.06, 0.9, 0.1), (0.97, 0.99, 0.1)]


@pytest.mark.parametrize("path", ["reflect", "transmit"])
@pytest.mark.parametrize(("albedo", "tau", "g"), [(0.95, 0.5, 0.6), (0.95, 1.0, 0.6), (1.0, 8.0, 0.0), (1.0, 0.5, 0.9)])
def test_tables_are_as_good_as_they_say(albedo, tau, g, path):
    """The adding walk of one layer is a lookup in its table."""
    stack = Stack([hg(albedo, tau, g)])
    exact = lamina.solve(stack, threads=1)
    values = exact.brdf if path == "reflect" else exact.btdf
    for at in LOOKED_UP:
        truth = values(*at)[0]
        found = lamina.estimate(stack, *at, "adding", 1, threads=1, path=path)
        assert found.stderr[0] == 0.0 and found.looked_up[0]
        assert abs(found.value[0] / truth - 1.0) < found.table_error < 3e-4


def test_a_graded_layers_table_is_as_good_from_below():
    stack = Stack([Medium(tau=1.0, profile=[Knot(0.0, 0.95, HenyeyGreenstein(0.6)), Knot(1.0, 0.5)])])
    exact = lamina.solve(stack, threads=1)
    for at in LOOKED_UP[:2]:
        found = lamina.estimate(stack, *at, "adding", 1, threads=1, side="bottom")
        # Two solves, each with slices good to 2e-4 at worst.
        assert found.value[0] == pytest.approx(exact.brdf(*at, "bottom")[0], rel=found.table_error + 2e-4)


LAYER = hg(0.9, 2.0, 0.6)
CLEAR = Medium(albedo=0.0, tau=0.5)


@pytest.mark.parametrize("stack", [Stack([LAYER]), Stack([CLEAR, LAYER]), Stack([LAYER], Black()),
                                   Stack([], HalfSpace(0.9)), Stack([], Lambert(0.5)),
                                   Stack([Medium(tau=1.0, profile=[Knot(0.0, 0.95), Knot(1.0, 0.5)])])])
def test_adding_says_when_a_value_is_read_from_a_table(stack):
    """One layer: the adding series ends with its first term."""
    found = lamina.estimate(stack, 0.5, 0.6, 1.0, "adding", 1 << 12, threads=1)
    assert found.looked_up.all() and not found.stderr.any() and not found.events.any()
    assert found.value[0] == pytest.approx(lamina.solve(stack, threads=1).brdf(0.5, 0.6, 1.0)[0], rel=3e-4)


@pytest.mark.parametrize("stack", [Stack([LAYER, LAYER]), Stack([LAYER], Lambert(0.3)), Stack([Interface(1.5), LAYER]),
                                   Stack([LAYER], Conductor(0.2, 3.0)), Stack([Interface(1.5, 0.3), LAYER])])
def test_adding_walks_where_light_goes_to_and_fro(stack):
    found = lamina.estimate(stack, 0.5, 0.6, 1.0, "adding", 1 << 14, seed=3, threads=1)
    assert not found.looked_up.any() and found.stderr.all() and found.events.all()
    truth = lamina.solve(stack, threads=1).brdf(0.5, 0.6, 1.0)[0]
    assert abs(found.value[0] - truth) < z_limit(5) * math.hypot(found.stderr[0], found.table_error * truth)


@pytest.mark.parametrize("arguments", [(0.5, 0.6, 1.0, "transfer"), (0.5, 0.6, 1.0, "scattering"),
                                       (None, 0.6, 0.0, "adding")])
def test_other_walks_of_one_layer_are_walks(arguments):
    found = lamina.estimate(Stack([LAYER]), *arguments, samples=1 << 12, threads=1)
    assert not found.looked_up.any() and found.stderr.all()


def test_channels_are_read_or_walked_each_for_itself():
    """The surface below is black in the first channel alone."""
    stack = Stack([LAYER], Lambert([0.0, 0.5, 0.5]))
    found = lamina.estimate(stack, 0.5, 0.6, 1.0, "adding", 1 << 12, threads=1)
    assert found.looked_up.tolist() == [True, False, False]


def test_the_command_says_that_there_was_no_walk(tmp_path, capsys):
    Stack([LAYER]).save(tmp_path / "stack.json")
    call = ["estimate", str(tmp_path / "stack.json"), "--mu-o", "0.5", "--mu-i", "0.6", "--samples", "4096",
            "--threads", "1", "--quiet", "--method"]
    assert main([*call, "adding"]) == 0
    assert capsys.readouterr().out.splitlines()[0].endswith(" +- 0 (no walk: known beforehand)")
    assert main([*call, "transfer"]) == 0
    assert "4096 samples" in capsys.readouterr().out


@pytest.mark.parametrize("method", ["scattering", "transfer", "adding"])
def test_the_thinnest_pieces(method):
    """Knots nearer to each other than rounding errors, and a medium so thin that single precision has no number for its
    thickness: what is left scatters as without them."""
    def estimated(layers, side="top"):
        return float(lamina.estimate(Stack(layers), 0.5, 0.5, method=method, samples=4096, side=side).value[0])

    knots = [Knot(0.0, 0.9), Knot(1e-17, 0.5), Knot(1.0, 0.2)]
    for side in ("top",) if method == "scattering" else ("top", "bottom"):
        assert estimated([Medium(tau=1.0, profile=knots)], side) == pytest.approx(
            estimated([Medium(tau=1.0, profile=[Knot(0.0, 0.5), knots[2]])], side), rel=1e-9)
    thin = estimated([Medium(0.9, 1e-300, HenyeyGreenstein(0.5))])
    assert thin == pytest.approx(1e-280 * estimated([Medium(0.9, 1e-20, HenyeyGreenstein(0.5))]), rel=1e-3)
    assert estimated([Medium(0.9, 1.0), Medium(0.5, 1e-17)]) == pytest.approx(estimated([Medium(0.9, 1.0)]), rel=0.05)

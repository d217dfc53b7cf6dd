# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates of searchlights split over machines, and on the command line."""

import copy
import json

import pytest
from searchlight_stacks import SLAB, VARNISHED
from test_estimate_searchlight import same
from walk_cases import SLAB as SLAB_WITHOUT_LENGTHS

import lamina
from lamina import Query, SearchlightQuery, ShardError
from lamina.cli import main
from lamina.walks.searchlight_shards import run_searchlight_shard
from lamina.walks.shards import load_part, merge, run_shard, save_part

SAMPLES = 300000
QUERY = SearchlightQuery(0.7, "transfer", (1.0, 0.3), (0.5, 2.0))


def part(number, count=3, stack=VARNISHED, query=QUERY, samples=SAMPLES, seed=4):
    return run_searchlight_shard(stack, query, samples, seed, (number, count), threads=1)


@pytest.fixture(scope="module")
def parts():
    return [part(number) for number in (1, 2, 3)]


def test_merged_parts_are_the_whole_to_the_last_bit(parts, tmp_path):
    whole = lamina.estimate_searchlight(VARNISHED, 0.7, SAMPLES, 4, threads=2, r=QUERY.r, q=QUERY.q)
    paths = [tmp_path / f"part{k}.json" for k in range(3)]
    for path, one in zip(paths, parts, strict=True):
        save_part(one, path)
    same(merge([load_part(paths[k]) for k in (2, 0, 1)]), whole)


@pytest.mark.parametrize(("change", "words"), [
    ({"seed": 5}, "parts.1.: seed = 5 but"),
    ({"query": SearchlightQuery(0.7, "transfer", (1.0,), (0.5, 2.0))}, "r = .1.0. but"),
    ({"samples": 2 * SAMPLES}, "blocks = "),
    ({"stack": SLAB}, "stack = "),
])
def test_parts_of_other_jobs(parts, change, words):
    with pytest.raises(ShardError, match=words):
        merge([parts[0], part(2, **change), parts[2]])


def test_the_scale_of_lengths_is_part_of_the_job():
    """Twice as large in every length: the same optical stack."""
    small, large = (lamina.Stack([lamina.Medium(sigma_s=1.0 / scale, sigma_a=0.1 / scale, thickness=scale)])
                    for scale in (1.0, 2.0))
    assert small.hash == large.hash
    with pytest.raises(ShardError, match="stack = "):
        merge([part(1, 2, small, samples=1), part(2, 2, large, samples=1)])


def test_missing_parts_and_other_kinds(parts):
    with pytest.raises(ShardError, match="part 2 of 3 is missing"):
        merge([parts[0], parts[2]])
    other = run_shard(SLAB_WITHOUT_LENGTHS, Query(0.5, 0.5), "transfer", 1, 0, (1, 3), threads=1)
    with pytest.raises(ShardError, match="parts.1.: not of the kind of parts.0."):
        merge([parts[0], other])


@pytest.mark.parametrize(("damage", "words"), [
    (lambda p: p.pop("beam"), "not a part of an estimate"),
    (lambda p: p.update(beam="lamp"), "beam = 'lamp': must be 'searchlight'"),
    (lambda p: p["job"].update(q=[-1.0]), "job.q = -1: must be at least 0 1/mm"),
    (lambda p: p["job"].update(r=[1.0]), "must be lists of .1, 1, 5, 15. finite numbers on each side"),
    (lambda p: p["job"].update(walk="guess"), "job.walk = 'guess': must be one of"),
    (lambda p: p["channels"][0].pop("endless"), "channels.0.: not a complete channel of a searchlight"),
    (lambda p: p["channels"][0].update(mirrored="all"), "mirrored = 'all': must lie in .0, 1."),
    (lambda p: p["channels"][0]["tallies"].pop(), "channels.0.: must be a list of"),
    (lambda p: p["channels"][0]["tallies"][0][0][2].pop(), "must be lists of .2, 2, 5, 15. finite numbers"),
    (lambda p: p["channels"][0]["tallies"][0][1][0].__setitem__(0, None), "must be lists of"),
    (lambda p: p["channels"][0]["tallies"][0].__setitem__(2, 17), "= 17: must be .*, the number of samples"),
    (lambda p: p["channels"][0]["tallies"][0].__setitem__(3, -1), "must be a whole number of events"),
])
def test_damaged_parts(parts, damage, words):
    damaged = copy.deepcopy(parts[0])
    damage(damaged)
    with pytest.raises(ShardError, match=words) as refused:
        merge([damaged, *parts[1:]])
    assert "\n" not in str(refused.value)


def test_the_command_line(tmp_path, capsys):
    VARNISHED.save(tmp_path / "stack.json")
    call = ["estimate-searchlight", str(tmp_path / "stack.json"), "--mu-i", "0.7", "--r", "1,.3", "--q", ".5",
            "--samples", "140000", "--seed", "4", "--threads", "1", "--quiet"]
    assert main([*call, "--json"]) == 0
    whole = capsys.readouterr().out
    shown = json.loads(whole)
    found = lamina.estimate_searchlight(VARNISHED, 0.7, 140000, 4, r=[1.0, 0.3], q=[0.5])
    assert shown["reflected_inside"] == {"value": found.reflected_inside.value.tolist(),
                                         "stderr": found.reflected_inside.stderr.tolist()}
    assert shown["mirrored"]["stderr"] == [0.0] and shown["samples"] == [143360]
    for number in (1, 2):
        assert main([*call, "--shard", f"{number}/2", "-o", str(tmp_path / f"part{number}.json")]) == 0
    assert main(["merge", str(tmp_path / "part2.json"), str(tmp_path / "part1.json"), "--json"]) == 0
    assert capsys.readouterr().out == whole
    assert main(call) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("reflectance: ") and " +- " in lines[0]
    assert any(line.startswith("reflected_inside 0.3 mm: ") for line in lines)
    assert any(line.startswith("transmitted_at 0.5 1/mm: 0 +- 0") for line in lines)


@pytest.mark.parametrize(("words", "sentence"), [
    (["--mu-i", "2"], "lamina: mu_i = 2.0: must be one number in (0, 1]"),
    (["--q", "-1"], "lamina: q = -1: must be at least 0 1/mm"),
    (["--shard", "1/2"], "lamina: --shard and -o go together"),
    (["--walk", "scattering"], "lamina: walk = 'scattering': "),
])
def test_bad_calls(words, sentence, tmp_path, capsys):
    VARNISHED.save(tmp_path / "stack.json")
    assert main(["estimate-searchlight", str(tmp_path / "stack.json"), "--quiet", *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith(sentence) and error.count("\n") == 1


def test_a_stack_without_lengths_is_refused(tmp_path, capsys):
    SLAB_WITHOUT_LENGTHS.save(tmp_path / "stack.json")
    assert main(["estimate-searchlight", str(tmp_path / "stack.json"), "--quiet"]) == 2
    assert "layers[0]: has no lengths, must have sigma_s and sigma_a (1/mm)" in capsys.readouterr().err

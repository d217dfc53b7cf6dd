# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates split over machines: the same bytes as in one run; parts that do not belong together are refused."""

import json

import pytest
from walk_cases import VARNISH

import lamina
from lamina import Query, ShardError
from lamina.cli import main
from lamina.walks.shards import load_part, merge, run_shard, save_part

SAMPLES = 400000
QUERY = Query(0.6, 0.8, 2.5)


def part(number, count=3, **changes):
    job = {"query": QUERY, "method": "transfer", "samples": SAMPLES, "seed": 4, **changes}
    return run_shard(VARNISH, shard=(number, count), threads=1, **job)


@pytest.fixture(scope="module")
def parts():
    return [part(number) for number in (1, 2, 3)]


def test_merged_parts_are_the_whole_to_the_last_bit(parts):
    whole = lamina.estimate(VARNISH, 0.6, 0.8, 2.5, "transfer", SAMPLES, seed=4, threads=2)
    merged = merge([parts[2], parts[0], parts[1]])
    for name in ("value", "stderr", "samples", "events"):
        assert getattr(merged, name).tobytes() == getattr(whole, name).tobytes()


def test_parts_survive_files(parts, tmp_path):
    paths = [tmp_path / f"part{k}.json" for k in range(3)]
    for path, one in zip(paths, parts, strict=True):
        save_part(one, path)
    assert [load_part(path) for path in paths] == parts


@pytest.mark.parametrize(("change", "words"), [
    ({"seed": 5}, "parts.1.: seed = 5 but"),
    ({"query": Query(0.5, 0.8, 2.5)}, "mu_o = 0.5"),
    ({"samples": 2 * SAMPLES}, "blocks = "),
    ({"method": "adding"}, "method = 'adding'"),
])
def test_parts_of_other_jobs(parts, change, words):
    with pytest.raises(ShardError, match=words):
        merge([parts[0], part(2, **change), parts[2]])


def test_missing_double_and_foreign_parts(parts):
    with pytest.raises(ShardError, match="part 2 of 3 is missing"):
        merge([parts[0], parts[2]])
    with pytest.raises(ShardError, match="part 1 of 3 is given twice"):
        merge([parts[0], parts[0], parts[1]])
    with pytest.raises(ShardError, match="part 2 of 4, but"):
        merge([parts[0], part(2, 4)])
    with pytest.raises(ValueError, match="shard = 4/3"):
        part(4)


@pytest.mark.parametrize("text", ["", "[1]", '{"schema": 1}', "cut"])
def test_files_that_are_no_parts(parts, text, tmp_path):
    path = tmp_path / "part.json"
    path.write_text(json.dumps(parts[0])[:200] if text == "cut" else text, encoding="utf-8")
    with pytest.raises(ShardError, match="part.json: not a"):
        load_part(path)


def test_the_command_line(tmp_path, capsys):
    VARNISH.save(tmp_path / "stack.json")
    call = ["estimate", str(tmp_path / "stack.json"), "--mu-o", "0.6", "--mu-i", "0.8", "--dphi", "2.5", "--samples",
            str(SAMPLES), "--seed", "4", "--threads", "1", "--quiet"]
    assert main([*call, "--json"]) == 0
    whole = capsys.readouterr().out
    for number in (1, 2):
        assert main([*call, "--shard", f"{number}/2", "-o", str(tmp_path / f"part{number}.json")]) == 0
    assert main(["merge", str(tmp_path / "part1.json"), str(tmp_path / "part2.json"), "--json"]) == 0
    assert capsys.readouterr().out == whole
    assert main(["merge", str(tmp_path / "part2.json")]) == 2
    assert "part 1 of 2 is missing" in capsys.readouterr().err
    assert main([*call, "--shard", "1/2"]) == 2
    assert "--shard and -o go together" in capsys.readouterr().err
    assert main(["merge", str(tmp_path / "stack.json")]) == 2
    assert "not a part" in capsys.readouterr().err

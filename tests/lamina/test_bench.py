# SPDX-License-Identifier: GPL-3.0-or-later
"""Each benchmark that needs no Blender runs to its end, with names that are public. tests/cycles runs the others."""

import re

import bench_names
import pytest


@pytest.mark.parametrize("name", bench_names.names(in_blender=False))
def test_a_second_of_the_benchmark(name):
    bench_names.require_a_table(name)


def test_benchmarks_use_and_replace_no_private_names():
    texts = {path.name: path.read_text(encoding="utf-8") for path in bench_names.BENCH.glob("*.py")}
    assert not [name for name, text in texts.items() if re.search(r"\b_core\b|\bsetattr\(|lamina(\.\w+)*\._", text)]


def test_an_unknown_benchmark_is_one_sentence():
    with pytest.raises(AssertionError, match="bench: nothing: must be one of solver, doubling, "):
        bench_names.require_a_table("nothing")

# SPDX-License-Identifier: GPL-3.0-or-later
"""Each benchmark that runs in Blender runs to its end, with the extension of `make extension`."""

import bench_names
import pytest


@pytest.mark.parametrize("name", bench_names.names(in_blender=True))
def test_a_second_of_the_benchmark(name):
    if not list((bench_names.BENCH.parent / "build/extension").glob("lamina-[0-9]*.zip")):
        pytest.skip("no extension in build/extension: run `make build/stamps/extension`")
    bench_names.require_a_table(name)

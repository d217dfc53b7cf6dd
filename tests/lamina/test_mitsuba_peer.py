# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's peer: Mitsuba renders the slab by LLVM, if the system has a library for it, and by scalar code."""

import sys
from pathlib import Path

import numpy as np
import pytest

import lamina

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import mitsuba_peer

PATHS = 1 << 14


def check(run):
    """The light that it sees is the slab's albedo, by the solver."""
    albedo, tau, g = mitsuba_peer.SLAB
    slab = lamina.Stack([lamina.Medium(albedo=albedo, tau=tau, phase=lamina.HenyeyGreenstein(g))])
    expected = lamina.solve(slab).reflectance(mitsuba_peer.MU)[0]
    assert abs(run["value"] - expected) < 4.0 * expected * np.sqrt(run["variance"] / PATHS)
    assert run["paths_per_second"] > 0.0


def test_both_variants():
    if not any("19" in path.name for path in mitsuba_peer._llvm_libraries()):
        pytest.skip("this system has no libllvm19")
    llvm, scalar = mitsuba_peer.measure(PATHS, (5,), 1)
    assert (llvm["variant"], scalar["variant"]) == ("llvm_ad_rgb", "scalar_rgb")
    assert llvm["compilation"] > 0.0 and "compilation" not in scalar
    check(llvm)
    check(scalar)


@pytest.mark.parametrize("libraries", [[], [Path("/nowhere/libLLVM-1.so")]])
def test_without_an_llvm_library_that_works(libraries, monkeypatch, capfd):
    monkeypatch.setattr(mitsuba_peer, "_llvm_libraries", lambda: libraries)
    (scalar,) = mitsuba_peer.measure(PATHS, (5,), 1)
    assert scalar["variant"] == "scalar_rgb"
    check(scalar)
    assert "Debian's package libllvm19 holds one" in capfd.readouterr().err

# SPDX-License-Identifier: GPL-3.0-or-later
"""The nearest stack to a measurement: stacks of the library come back from their own files, and what no stack shows is
said."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest
from measured_tables import facets, measured
from test_files import merl_file

import lamina
from lamina import Conductor, HalfSpace, HenyeyGreenstein, Interface, Lambert, Stack


def file_of(stack, folder):
    lamina.rgl.save_bsdf(stack, folder / "sample.bsdf", size=96, angles=32)
    return folder / "sample.bsdf"


def test_a_matte_surface(tmp_path):
    found = lamina.nearest(file_of(Stack([], Lambert([0.5, 0.3, 0.1])), tmp_path))
    assert found.kind == "a matte surface" and list(found.tried) == [found.kind]
    assert found.stack.base.reflectance == pytest.approx((0.5, 0.3, 0.1), rel=2e-3)
    assert found.error < 0.002 and found.worst < 0.003 and found.remarks == ()
    assert found.stack.name == "sample" and "mean error" in found.stack.source


def test_data_that_gain_much_light_are_a_remark(tmp_path):
    path = merl_file(tmp_path / "bright.binary", np.full((90, 90, 180), 20.0))
    with pytest.warns(UserWarning, match="times the light that they receive"):
        found = lamina.nearest(path)
    assert found.kind == "a matte surface" and found.remarks[0].startswith("The data reflect up to 6")
    assert found.remarks[0].endswith(" times the light that they receive, and count as scaled down.")


def test_a_metal(tmp_path):
    metal = Conductor(facing=[0.9, 0.7, 0.4], grazing=[0.95, 0.85, 0.7], alpha=0.25)
    found = lamina.nearest(file_of(Stack([], metal), tmp_path))
    assert found.kind == "a rough metal" and found.error < 0.012
    assert found.stack.base.alpha == pytest.approx(0.25, rel=0.02)
    assert found.stack.base.facing == pytest.approx(metal.facing, abs=0.02)
    assert found.tried["a matte surface"] > 0.5


def test_a_pigment_under_a_coat(tmp_path):
    paint = Stack([Interface(1.45, alpha=0.2)], HalfSpace([0.9, 0.7, 0.5], HenyeyGreenstein(0.5)))
    texts = []
    found = lamina.nearest(file_of(paint, tmp_path), progress=lambda fraction, text: texts.append((fraction, text)))
    assert found.kind == "a pigmented medium under a coat" and found.error < 0.006
    (coat,) = found.stack.layers
    assert coat.ior == pytest.approx(1.45, abs=0.01) and coat.alpha == pytest.approx(0.2, abs=0.005)
    assert found.stack.base.albedo == pytest.approx((0.9, 0.7, 0.5), abs=0.03)
    fractions = [fraction for fraction, _ in texts]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0 and "Trying a powder" in {text for _, text in texts}
    assert Stack.from_json(found.stack.to_json()) == found.stack


def test_what_no_stack_shows_is_said():
    """A lobe back to the light, which nothing in the library has."""
    def retro(wi, wo):
        back = (wi * wo).sum(-1).clip(0.0)
        return 0.1 / math.pi + 0.25 * back**20
    found = lamina.nearest(measured(retro))
    assert found.error > 0.1 and any("light back to its source" in remark for remark in found.remarks)
    assert str(found).startswith(f"{found.kind}: mean error") and found.worst >= found.error


def test_cancel_and_bad_arguments():
    with pytest.raises(lamina.Cancelled):
        lamina.nearest(measured(facets(0.2, 0.1, 0.3)), cancel=lambda: True)
    with pytest.raises(lamina.ArgumentError, match=r"^measured = 5: must be a lamina\.Measured"):
        lamina.nearest(5)
    with pytest.raises(lamina.MeasurementError, match="unknown format"):
        lamina.nearest("x.txt")


def test_the_command(tmp_path):
    path = file_of(Stack([], Lambert(0.4)), tmp_path)
    command = [sys.executable, "-m", "lamina", "match", str(path), "--quiet"]
    done = subprocess.run([*command, "--json", "-o", str(tmp_path / "out.json")], capture_output=True, text=True,
                          timeout=120)
    assert done.returncode == 0 and done.stderr == ""
    result = json.loads(done.stdout)
    assert result["kind"] == "a matte surface" and Stack.load(tmp_path / "out.json").to_json() == result["stack"]
    bad = subprocess.run([*command[:-2], str(tmp_path / "nowhere.bsdf")], capture_output=True, text=True, timeout=120)
    assert bad.returncode == 1 and bad.stderr.startswith("lamina: ") and bad.stderr.count("\n") == 1
    (tmp_path / "bad.bsdf").write_bytes(b"bad")
    bad = subprocess.run([*command[:-2], str(tmp_path / "bad.bsdf")], capture_output=True, text=True, timeout=120)
    assert bad.returncode == 2 and "must be a .bsdf file of RGL" in bad.stderr

# SPDX-License-Identifier: GPL-3.0-or-later
"""The nearest stack to a measured material: by the operator, by the function, and beside the window."""

import bpy
import pytest


@pytest.fixture
def paint(lamina, tmp_path):
    """A .bsdf file of a matte surface under a coat."""
    stack = lamina.Stack([lamina.Interface(1.45, alpha=0.2)], lamina.Lambert([0.6, 0.4, 0.2]))
    lamina.rgl.save_bsdf(stack, tmp_path / "paint.bsdf", size=64, angles=24)
    return tmp_path / "paint.bsdf"


def test_the_operator_does_what_the_function_does(addon, lamina, material, call, paint):
    assert call(bpy.ops.lamina.match_measurement, material, filepath=str(paint)) == {"FINISHED"}
    other = bpy.data.materials.new("Other")
    sentence = addon.editing.match_job.match(other, str(paint))
    assert sentence.startswith("A matte surface under a coat, mean error 0.")
    data = addon.editing.stack_io.to_dict(material)
    assert data == addon.editing.stack_io.to_dict(other)
    assert data["layers"][0]["alpha"] == pytest.approx(0.2, abs=0.01) and data["base"]["kind"] == "lambert"


def test_beside_the_window(addon, material, paint):
    """As the operator polls it; a cancelled search changes nothing."""
    jobs = addon.editing.match_job
    before = addon.editing.stack_io.to_dict(material)
    job = jobs.start(material, str(paint))
    assert jobs.running_for(material) is job
    job.cancel()
    job.wait(60.0)
    with pytest.raises(addon.base.native.require().Cancelled):
        job.finish()
    jobs.forget()
    assert addon.editing.stack_io.to_dict(material) == before
    job = jobs.start(material, str(paint))
    job.wait(120.0)
    assert job.finish() is material and job.sentence.startswith("A matte surface under a coat")
    jobs.forget()
    assert addon.editing.stack_io.to_dict(material) != before


def test_a_file_that_cannot_be_read_changes_nothing(addon, material, call, tmp_path):
    before = addon.editing.stack_io.to_dict(material)
    (tmp_path / "bad.bsdf").write_bytes(b"bad")
    for name, words in (("nowhere.bsdf", "No such file"), ("bad.bsdf", r"must be a \.bsdf file of RGL")):
        with pytest.raises(RuntimeError, match=words):
            call(bpy.ops.lamina.match_measurement, material, filepath=str(tmp_path / name))
    assert addon.editing.stack_io.to_dict(material) == before

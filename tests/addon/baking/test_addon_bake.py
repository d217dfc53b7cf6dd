# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: blocking, in a worker, failing, cancelled; fresh and stale."""

import math
import threading
from types import SimpleNamespace

import bpy
import own_blender
import pytest
from addon_helpers import detached, image_of, snapshot


def finish(addon):
    """The modal operator's action after its worker has ended."""
    job = addon.baking.bake_job.running()
    job.wait(60.0)
    addon.baking.bake_job.forget()
    return job.finish()


def test_operator_equals_function(addon, lamina, material, call):
    other = material.copy()
    addon.baking.bake_job.bake_material(material)
    assert call(bpy.ops.lamina.bake, other) == {"FINISHED"}
    assert snapshot(material) == snapshot(other)
    assert material.lamina.result.stack_hash == other.lamina.result.stack_hash


def test_worker_equals_blocking(addon, lamina, material):
    other = material.copy()
    addon.baking.bake_job.bake_material(material)
    job = addon.baking.bake_job.start(other)
    assert addon.baking.bake_job.running_for(other) is job and addon.baking.bake_job.running_for(material) is None
    assert finish(addon) == other
    assert snapshot(material) == snapshot(other)
    assert job.fraction > 0.0 and job.text


def test_the_report_is_kept(addon, lamina, material):
    lut = addon.baking.bake_job.bake_material(material)
    result = material.lamina.result
    kept = {name: value for name, value in lut.report.items() if not name.startswith("slice_errors")}
    assert result.report == kept and kept["fit_error"] > 0.0 and kept["worst_slice"]["error"] > 0.0
    assert result.quality == "preview" and result.stack_hash == lut.header["stack_hash"]
    names = [name for name, _ in addon.ui.numbers.result_lines(result)]
    assert names == ["Fit Error", "Worst At", "Albedo Error", "Energy Error", "Closures", "Baked"]


def test_the_report_of_a_sheet_tells_its_worst_transmission(addon, lamina, material):
    addon.editing.stack_io.assign_stack(material, lamina.Stack([lamina.Medium(0.9, tau=0.2)]))
    lut = addon.baking.bake_job.bake_material(material)
    worst, result = lut.report["worst_slice_transmission"], material.lamina.result
    assert result.report["worst_slice_transmission"] == worst and worst["error"] > 0.0
    lines = addon.ui.numbers.result_lines(result)
    assert [name for name, _ in lines][:4] == ["Fit Error", "Worst At", "Transmission", "Worst At"]
    assert f"{addon.base.messages.percent(worst['error'])} worst" in lines[2][1]
    assert f"{math.degrees(math.acos(worst['mu_o'])):.0f}° view" in lines[3][1]


def test_fresh_and_stale(addon, lamina, material):
    state = addon.baking.bake_job.state
    assert state(material) == "none"
    addon.baking.bake_job.bake_material(material)
    assert state(material) == "fresh"
    tau = material.lamina.layers[0].tau
    material.lamina.layers[0].tau = 3.3
    assert state(material) == "stale"
    material.lamina.layers[0].tau = tau
    assert state(material) == "fresh"
    material.lamina.layers.clear()
    material.lamina.base.kind = "none"
    assert state(material) == "invalid"


def test_a_table_that_was_deleted(addon, lamina, material):
    bake = addon.baking.bake_job
    bake.bake_material(material)
    bpy.data.images.remove(image_of(material.lamina.node_group))
    assert bake.state(material) == "none"
    bake.bake_material(material)
    assert bake.state(material) == "fresh"
    assert image_of(material.lamina.node_group).packed_file is not None


def test_editing_while_baking_ends_stale(addon, lamina, material):
    addon.baking.bake_job.start(material)
    material.lamina.layers[0].tau = 9.0
    material.name = "Renamed"
    assert finish(addon) == material
    assert addon.baking.bake_job.state(material) == "stale"


def failing(error):
    def bake(stack, **_arguments):
        raise error

    return bake


def test_a_failed_bake_loses_nothing(addon, lamina, material, call, monkeypatch):
    addon.baking.bake_job.bake_material(material)
    before = snapshot(material)
    material.lamina.layers[0].tau = 2.5
    monkeypatch.setattr(
        lamina, "bake", failing(lamina.SolveError("layers[0]: did not converge, energy error 1e-3"))
    )
    with pytest.raises(RuntimeError, match="Layer 1 “Dust”: did not converge"):
        call(bpy.ops.lamina.bake, material)
    assert snapshot(material) == before
    assert addon.baking.bake_job.failure(material).startswith("Layer 1 “Dust”: did not converge")
    material.lamina.layers[0].tau = 2.6
    assert addon.baking.bake_job.failure(material) == "", "another stack, another answer"


def test_a_bug_is_one_sentence_too(addon, lamina, material, call, monkeypatch):
    monkeypatch.setattr(lamina, "bake", failing(ZeroDivisionError("division by zero")))
    with pytest.raises(RuntimeError) as caught:
        call(bpy.ops.lamina.bake, material)
    assert "ZeroDivisionError: division by zero" in str(caught.value)
    assert "Traceback" not in addon.baking.bake_job.failure(material)


def test_an_empty_stack_is_refused_in_a_sentence(addon, lamina, material, call):
    material.lamina.layers.clear()
    material.lamina.base.kind = "none"
    with pytest.raises(RuntimeError, match="at least one layer"):
        call(bpy.ops.lamina.bake, material)
    assert material.lamina.node_group is None


def test_a_layer_in_error_is_selected(addon, lamina, material, call):
    addon.editing.layer_list.add_layer(material)
    bad = material.lamina.layers[1]
    bad.infinite = bad.varying = True
    material.lamina.active_index = 0
    with pytest.raises(RuntimeError, match="Layer 2 “Dust”"):
        call(bpy.ops.lamina.bake, material)
    assert material.lamina.active_index == 1


def endless(lamina):
    """A bake that ends only by a cancel, and the event that it has begun."""
    begun = threading.Event()

    def bake(stack, progress=None, cancel=None, **_arguments):
        progress(0.25, "Solving")
        begun.set()
        while not cancel():
            threading.Event().wait(0.005)
        raise lamina.Cancelled

    return bake, begun


def test_cancel_keeps_the_old_lut(addon, lamina, material, call, monkeypatch):
    addon.baking.bake_job.bake_material(material)
    before = snapshot(material)
    bake, begun = endless(lamina)
    monkeypatch.setattr(lamina, "bake", bake)
    material.lamina.layers[0].tau = 4.0
    job = addon.baking.bake_job.start(material)
    assert begun.wait(10.0) and not job.done
    with pytest.raises(RuntimeError, match="A bake is running"):
        call(bpy.ops.lamina.bake, material)
    assert bpy.ops.lamina.cancel(work="BAKE") == {"FINISHED"}
    with pytest.raises(lamina.Cancelled):
        finish(addon)
    assert bpy.ops.lamina.cancel(work="BAKE") == {"CANCELLED"}
    assert job.done and snapshot(material) == before and addon.baking.bake_job.state(material) == "stale"


def test_a_cancel_that_comes_too_late_still_keeps_the_old_lut(addon, lamina, material):
    addon.baking.bake_job.bake_material(material)
    before = snapshot(material)
    material.lamina.layers[0].tau = 4.0
    job = addon.baking.bake_job.start(material)
    job.wait(60.0)
    job.cancel()
    assert finish(addon) is None and snapshot(material) == before


def test_the_real_bake_hears_a_cancel(addon, lamina, material):
    with pytest.raises(lamina.Cancelled):
        addon.baking.bake_job.bake_material(material, cancel=lambda: True)
    assert material.lamina.node_group is None and not bpy.data.images


@pytest.mark.parametrize("way", ["new file", "material removed", "disabled"])
def test_a_bake_whose_material_goes_away_ends_quietly(addon, lamina, material, monkeypatch, way):
    bake, begun = endless(lamina)
    monkeypatch.setattr(lamina, "bake", bake)
    job = addon.baking.bake_job.start(material)
    assert begun.wait(10.0)
    if way == "new file":
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    elif way == "material removed":
        bpy.data.materials.remove(material)
        addon.baking.bake_job.stop()
    else:
        addon.baking.bake_job.unregister()
        addon.baking.bake_job.register()
    assert job.done and addon.baking.bake_job.running() is None


def test_threads_and_quality_reach_the_bake(addon, lamina, material, monkeypatch):
    seen = {}
    real = lamina.bake

    def bake(stack, **arguments):
        seen.update(arguments)
        return real(stack, **arguments)

    monkeypatch.setattr(lamina, "bake", bake)
    bpy.context.preferences.addons[addon.__package__].preferences.threads = 1
    try:
        addon.baking.bake_job.bake_material(material)
    finally:
        bpy.context.preferences.addons[addon.__package__].preferences.threads = 0
    assert seen["threads"] == 1 and seen["quality"] == "preview"


def test_the_basis_reaches_the_bake(addon, lamina, material):
    standard = addon.baking.bake_job.bake_material(material)
    material.lamina.basis = "accurate"
    accurate = addon.baking.bake_job.bake_material(material)
    few, many = map(addon.base.preferences.table_basis, ("standard", "accurate"))
    assert (standard.header["basis"], accurate.header["basis"]) == (few, many)
    assert material.lamina.result.basis == many
    assert accurate.report["fit_error"] < standard.report["fit_error"]
    addon.baking.bake_job.start(material)
    finish(addon)
    assert material.lamina.result.basis == many
    assert ("Closures", f"{accurate.report['closures']}, accurate fit") in addon.ui.numbers.result_lines(
        material.lamina.result
    )


@pytest.mark.parametrize(("name", "chosen", "usual"),
                         [("basis", "accurate", "standard"), ("quality", "preview", "final")])
def test_defaults_come_from_the_preferences(addon, name, chosen, usual):
    settings = bpy.context.preferences.addons[addon.__package__].preferences
    setattr(settings, f"default_{name}", chosen)
    material = bpy.data.materials.new("New")
    addon.editing.layer_list.add_stack(material)
    setattr(settings, f"default_{name}", usual)
    assert getattr(material.lamina, name) == chosen


def test_run_state_is_never_in_the_blend(addon, lamina, material, monkeypatch):
    bake, begun = endless(lamina)
    before = set(material.lamina.keys()) if hasattr(material.lamina, "keys") else set()
    monkeypatch.setattr(lamina, "bake", bake)
    addon.baking.bake_job.start(material)
    begun.wait(10.0)
    after = set(material.lamina.keys()) if hasattr(material.lamina, "keys") else set()
    addon.baking.bake_job.stop()
    assert before == after


class Window:
    """Stands for Blender's window manager and workspace: without a window there are neither."""

    def __init__(self):
        self.timers, self.text, self.followed = [], None, []
        self.window_manager = self.workspace = self
        self.window = None

    def event_timer_add(self, _interval, window):
        self.timers.append(object())
        return self.timers[-1]

    def event_timer_remove(self, timer):
        self.timers.remove(timer)

    def modal_handler_add(self, operator):
        self.followed.append(operator)

    def status_text_set(self, text):
        self.text = text


@pytest.mark.parametrize("end", ["done", "cancelled", "failed"])
def test_the_operator_says_how_the_bake_ended(addon, lamina, material, end):
    operator = detached(addon, addon.operators.bake.LAMINA_OT_bake)
    material.lamina.quality = "preview"
    job = addon.baking.bake_job.start(material)
    if end == "cancelled":
        job.cancel()
    job.wait(60.0)
    if end == "failed":
        job.error = lamina.SolveError("layers[0].tau = 3: an error of this test")
    addon.baking.bake_job.forget()
    result = operator.ended(SimpleNamespace(), job)
    (level, text), = operator.reports
    assert (result, level) == {"done": ({"FINISHED"}, "INFO"), "cancelled": ({"CANCELLED"}, "INFO"),
                               "failed": ({"CANCELLED"}, "ERROR")}[end]
    assert {"done": f"Baked {material.name} in ", "cancelled": "Update cancelled; the earlier one is kept",
            "failed": "an error of this test"}[end] in text
    assert (addon.baking.bake_job.failure(material) != "") == (end == "failed")


@pytest.mark.parametrize("end", ["disabled", "cancelled", "done"])
def test_the_status_line_goes_with_the_operator(addon, lamina, material, monkeypatch, end):
    bake, begun = endless(lamina)
    monkeypatch.setattr(lamina, "bake", bake)
    window = Window()
    operator = type("Operator", (addon.operators.following.Following,), {"jobs": addon.baking.bake_job})()
    operator.ended = lambda context, job: {"FINISHED"}
    assert operator.follow(window, addon.baking.bake_job.start(material), "Lamina bakes Bronze") == {"RUNNING_MODAL"}
    assert begun.wait(10.0) and window.text == "Lamina bakes Bronze | ESC: Cancel" and len(window.timers) == 1
    if end == "disabled":
        own_blender.disable()
        own_blender.enable()
    elif end == "cancelled":
        operator.cancel(window)
    else:
        job = addon.baking.bake_job.running()
        job.cancel()
        job.wait(10.0)
        assert operator.modal(window, SimpleNamespace(type="TIMER", value="")) == {"FINISHED"}
    assert window.text is None and window.timers == []


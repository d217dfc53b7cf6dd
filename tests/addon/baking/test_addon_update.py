# SPDX-License-Identifier: GPL-3.0-or-later
"""Updates. Timers do not run in the background, so the tests call the timer's function themselves."""

import threading
import time
from types import SimpleNamespace

import bpy
import numpy as np
import own_blender
import pytest
from addon_helpers import image_of, look_until_rest, pixels, snapshot


@pytest.fixture
def update(addon, lamina, material, monkeypatch):
    """The module of updates, with a baked material that comes to rest at once."""
    addon.baking.bake_job.bake_material(material)
    addon.baking.update.leave(material)
    monkeypatch.setattr(addon.baking.update, "REST", 0.0)
    yield addon.baking.update
    addon.baking.update.stop()
    addon.baking.update._followed.clear()


@pytest.fixture
def jobs(update, monkeypatch):
    """(whole or coarse, options) of each bake that is started."""
    seen, real = [], update.UpdateJob

    class Watched(real):
        def __init__(self, material, is_whole, options=None):
            seen.append((is_whole, options or {}))
            super().__init__(material, is_whole, options)

    monkeypatch.setattr(update, "UpdateJob", Watched)
    return seen


@pytest.fixture
def by_hand(addon):
    """by_hand(): turns the preference off, until the end of the test."""
    preferences = bpy.context.preferences.addons[own_blender.MODULE].preferences
    yield lambda: setattr(preferences, "automatic", False)
    preferences.automatic = True


def show_coarse(update):
    """One bake, as while a slider moves."""
    update.poll()
    update.running().wait()
    update.poll()


def shown(material):
    return pixels(image_of(material.lamina.node_group))


def test_nothing_runs_while_nothing_changes(update, material):
    assert update.poll() is None and update.running() is None


def test_a_changed_layer_is_shown_coarsely_in_the_same_nodes(addon, lamina, update, material, jobs):
    group = material.lamina.node_group
    nodes, before = {node.name for node in group.nodes}, shown(material)
    closures = addon.nodes.node_group.closures(material)
    material.lamina.quality, material.lamina.layers[0].tau = "final", 2.5
    show_coarse(update)
    assert jobs[0] == (False, {}) and addon.baking.bake_job.state(material) == "other" and update.is_pending(material)
    assert {node.name for node in group.nodes} == nodes and material.lamina.node_group == group
    expected = lamina.bake(addon.editing.stack_io.to_stack(material), "preview", closures=closures,
                           basis=addon.base.preferences.table_basis("standard")).image()
    assert np.array_equal(shown(material)[: len(expected)], expected)
    assert not np.array_equal(shown(material), before)
    assert material.lamina.result.quality == "preview"


def test_at_rest_it_is_the_bake_that_was_asked_for(addon, lamina, update, material, jobs):
    material.lamina.quality, material.lamina.basis = "final", "accurate"
    material.lamina.layers[0].tau = 2.5
    assert update.WORKING in look_until_rest(update)
    assert [whole for whole, _options in jobs] == [False, True] and not update.is_pending(material)
    assert addon.baking.bake_job.state(material) == "fresh"
    expected = lamina.bake(addon.editing.stack_io.to_stack(material), "final",
                           basis=addon.base.preferences.table_basis("accurate"))
    assert np.array_equal(shown(material)[: len(expected.image())], expected.image())
    assert material.lamina.result.curves == addon.baking.bake_job.curves_of(expected.stack, expected)
    group = material.lamina.node_group
    assert len(bpy.data.images) == 1 and image_of(group).packed_file is not None
    assert image_of(group).name == f"Lamina {material.name}"


def test_another_quality_or_fit_is_baked_by_itself(addon, update, material):
    for name, value in (("quality", "final"), ("basis", "accurate"), ("quality", "preview")):
        setattr(material.lamina, name, value)
        assert addon.baking.bake_job.state(material) == "other" and update.is_pending(material)
        look_until_rest(update)
        assert addon.baking.bake_job.state(material) == "fresh"


def test_a_callback_only_takes_note(update, material):
    before = snapshot(material)
    for step in range(100):
        material.lamina.layers[0].tau = 1.0 + 0.01 * step
    assert update.running() is None and snapshot(material) == before
    look_until_rest(update)
    assert snapshot(material) != before


@pytest.mark.parametrize("name, value", [
    ("albedo", (0.1, 0.2, 0.3)), ("tau", 3.0), ("g", 0.1), ("phase", "rayleigh"), ("infinite", True),
    ("varying", True), ("tau_per_channel", True), ("mode", "coefficients"),
])  # fmt: skip
def test_every_property_of_a_layer_is_followed(addon, update, material, name, value):
    setattr(material.lamina.layers[0], name, value)
    look_until_rest(update)
    assert addon.baking.bake_job.state(material) == "fresh"


@pytest.mark.parametrize("name, value", [("kind", "none"), ("kind", "half-space"), ("reflectance", (0.9, 0.1, 0.1))])
def test_the_base_is_followed(addon, update, material, name, value):
    setattr(material.lamina.base, name, value)
    look_until_rest(update)
    assert addon.baking.bake_job.state(material) == "fresh"


def test_the_largest_thickness_is_followed_in_the_same_nodes(addon, update, material):
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    look_until_rest(update)
    group = material.lamina.node_group
    nodes = [node.as_pointer() for node in group.nodes]
    layer.tau = 3.0
    show_coarse(update)
    assert [node.as_pointer() for node in group.nodes] == nodes
    assert addon.nodes.node_group.group_nodes(material)[0].inputs["Thickness"].default_value == pytest.approx(3.0)

    def constants():
        return {node.label: [socket.default_value for socket in node.inputs] for node in group.nodes
                if node.type == "MATH"}  # fmt: skip

    updated = constants()
    lut = addon.baking.bake_job.bake_material(material)
    assert [node.as_pointer() for node in group.nodes] != nodes, "a bake that was asked for draws anew"
    assert lut.header["axes"]["tau"]["count"] > 1 and constants() == updated


def test_layers_that_come_and_go_are_followed(addon, update, material):
    edits = addon.editing.layer_list
    for edit in (edits.add_layer, edits.duplicate_layer, edits.remove_layer):
        edit(material)
        look_until_rest(update)
        assert addon.baking.bake_job.state(material) == "fresh"
    material.lamina.layers[0].g = 0.3
    look_until_rest(update)
    assert addon.editing.layer_list.move_layer(material, "DOWN") or addon.editing.layer_list.move_layer(material, "UP")
    look_until_rest(update)
    assert addon.baking.bake_job.state(material) == "fresh"


def test_the_newest_state_wins(addon, lamina, update, material, monkeypatch):
    begun, go, baked = threading.Event(), threading.Event(), []
    real = lamina.bake

    def slow(stack, **arguments):
        baked.append(stack.to_json()["layers"][0]["tau"])
        begun.set()
        go.wait(10.0)
        return real(stack, **arguments)

    monkeypatch.setattr(lamina, "bake", slow)
    material.lamina.layers[0].tau = 2.0
    update.poll()
    assert begun.wait(10.0)
    for tau in (3.0, 4.0, 5.0):
        material.lamina.layers[0].tau = tau
        assert update.poll() == update.WORKING
    go.set()
    look_until_rest(update)
    assert baked == [2.0, 5.0, 5.0] and addon.baking.bake_job.state(material) == "fresh"


def test_a_long_bake_of_an_old_state_is_given_up(addon, lamina, update, material, monkeypatch):
    before, real = snapshot(material), lamina.bake

    seen = []

    def endless(stack, cancel=None, **arguments):
        seen.append(arguments.get("nodes"))
        if stack.to_json()["layers"][0]["tau"] == 5.0:
            return real(stack, cancel=cancel, **arguments)
        while not cancel():
            time.sleep(0.001)
        raise lamina.Cancelled

    monkeypatch.setattr(lamina, "bake", endless)
    monkeypatch.setattr(update, "PATIENCE", 0.0)
    material.lamina.layers[0].tau = 2.0
    update.poll()
    assert update.poll() == update.WORKING and snapshot(material) == before
    material.lamina.layers[0].tau = 5.0
    look_until_rest(update)
    assert addon.baking.bake_job.state(material) == "fresh" and addon.baking.bake_job.failure(material) == ""
    assert seen == [None, update.NODES, None], "what follows a bake that was given up leaves something out, till rest"


def test_an_error_is_shown_and_spoils_nothing(addon, lamina, update, material, monkeypatch):
    before, real = snapshot(material), lamina.bake

    def bake(stack, **arguments):
        raise lamina.SolveError("layers[0]: did not converge, energy error 1e-3")

    monkeypatch.setattr(lamina, "bake", bake)
    material.lamina.layers[0].tau = 2.0
    look_until_rest(update)
    assert addon.baking.bake_job.failure(material).startswith("Layer 1 “Dust”: did not converge")
    assert snapshot(material) == before
    monkeypatch.setattr(lamina, "bake", real)
    material.lamina.layers[0].tau = 2.1
    look_until_rest(update)
    assert addon.baking.bake_job.failure(material) == "" and addon.baking.bake_job.state(material) == "fresh"


def test_layers_that_cannot_be_baked_are_told(addon, update, material):
    before = snapshot(material)
    addon.editing.layer_list.add_layer(material)
    look_until_rest(update)
    before = snapshot(material)
    material.lamina.layers[0].infinite = material.lamina.layers[0].varying = True
    look_until_rest(update)
    assert addon.baking.bake_job.failure(material) and snapshot(material) == before


def test_a_slow_stack_is_coarse_while_edited_and_whole_at_rest(addon, update, material, monkeypatch, jobs):
    material.lamina.layers[0].varying = True
    look_until_rest(update)
    monkeypatch.setattr(update, "SLOW", 0.0)
    jobs.clear()
    material.lamina.layers[0].g = 0.2
    look_until_rest(update)
    assert jobs == [(False, {"row_stride": update.ROW_STRIDE}), (True, {})]
    assert addon.baking.bake_job.state(material) == "fresh"


def test_with_the_preference_off_nothing_happens_by_itself(addon, update, material, by_hand):
    before = snapshot(material)
    by_hand()
    material.lamina.layers[0].tau = 4.0
    material.lamina.quality = "final"
    assert update.poll() is None and snapshot(material) == before
    assert addon.baking.bake_job.state(material) == "stale" and not update.is_pending(material)


def test_what_waits_is_dropped_when_the_preference_is_turned_off(addon, update, material, by_hand):
    before = snapshot(material)
    material.lamina.layers[0].tau = 4.0
    by_hand()
    look_until_rest(update)
    assert snapshot(material) == before and not update.is_pending(material)


def test_a_render_has_the_update_finished_first(addon, update, material, monkeypatch):
    """As if Blender had a window: in the background, scripts decide when to bake."""
    before_render = addon.baking.before_render
    monkeypatch.setattr(before_render, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
    monkeypatch.setattr(update, "REST", 1e9)
    material.lamina.quality, material.lamina.layers[0].tau = "final", 2.5
    before_render._before_render()
    assert addon.baking.bake_job.state(material) == "fresh" and not update.are_pending()


def test_a_render_does_not_wait_for_a_preview(addon, update, material, monkeypatch):
    asked = []

    def is_bound():
        asked.append(None)
        assert len(asked) < 1000, "it waits for ever"
        return True

    monkeypatch.setattr(addon.base.renders, "is_bound_to_preview", is_bound)
    material.lamina.layers[0].tau = 2.5
    update.finish()
    assert update.are_pending() and addon.baking.bake_job.state(material) == "stale"


@pytest.mark.parametrize("deaf", [False, True])
def test_the_thread_of_a_render_waits_for_the_main_thread(addon, update, material, monkeypatch, deaf):
    before_render, renders = addon.baking.before_render, addon.base.renders
    monkeypatch.setattr(before_render, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
    monkeypatch.setattr(before_render, "DEAF", 0.3)
    if deaf:
        monkeypatch.setattr(before_render.sys, "_current_frames", dict)
    monkeypatch.setattr(update, "REST", 1e9)
    material.lamina.quality, material.lamina.layers[0].tau = "final", 2.5
    render = threading.Thread(target=before_render._before_render)
    render.start()
    if deaf:
        render.join(60.0)
        assert not render.is_alive() and addon.baking.bake_job.state(material) == "stale", "it does not wait for ever"
        return
    while render.is_alive():
        update.poll()
        time.sleep(0.001)
    assert addon.baking.bake_job.state(material) == "fresh" and not renders.is_held()


def test_a_render_of_our_own_waits_for_nothing(addon, update, material, monkeypatch):
    before_render = addon.baking.before_render
    monkeypatch.setattr(before_render, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
    material.lamina.layers[0].tau = 2.5
    with addon.base.renders.own_render():
        before_render._before_render()
    assert addon.baking.bake_job.state(material) == "stale"


def test_a_saved_file_holds_the_last_picture(addon, update, material, tmp_path):
    material.use_fake_user = True
    material.lamina.layers[0].tau = 2.5
    while update.poll() == update.WORKING:
        time.sleep(0.001)
    last, name = shown(material), image_of(material.lamina.node_group).name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "update.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "update.blend"))
    assert np.array_equal(pixels(bpy.data.images[name]), last)
    material = bpy.data.materials["Bronze"]
    material.lamina.layers[0].tau = 3.5
    look_until_rest(update)
    assert addon.baking.bake_job.state(material) == "fresh", "changes in a reopened file are followed"


@pytest.mark.parametrize("way", ["new file", "material removed", "stack removed", "baked"])
def test_what_ends_a_running_job(addon, update, material, call, way):
    material.lamina.layers[0].tau = 2.0
    update.poll()
    if way == "new file":
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    elif way == "material removed":
        bpy.data.materials.remove(material)
    elif way == "stack removed":
        addon.editing.layer_list.remove_stack(material)
    else:
        assert call(bpy.ops.lamina.bake, material) == {"FINISHED"}
        assert update.running() is None
    look_until_rest(update)
    assert update.running() is None
    if way == "stack removed":
        assert material.lamina.node_group is None


def test_an_opened_file_bakes_nothing(addon, update, material, tmp_path):
    """Neither at once nor at an undo: only materials that change in this session are followed."""
    material.use_fake_user = True
    material.lamina.layers[0].tau = 7.0
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "stale.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "stale.blend"))
    update._on_undo()
    assert addon.baking.bake_job.state(bpy.data.materials["Bronze"]) == "stale"
    assert update.poll() is None and not update.are_pending()


def test_a_copy_gets_its_own_group(addon, update, material):
    other = material.copy()
    other.lamina.layers[0].tau = 7.0
    before = snapshot(material)
    look_until_rest(update)
    assert other.lamina.node_group != material.lamina.node_group and snapshot(material) == before

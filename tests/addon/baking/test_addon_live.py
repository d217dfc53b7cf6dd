# SPDX-License-Identifier: GPL-3.0-or-later
"""Live editing. Timers do not run in the background, so the tests call the timer's function themselves."""

import threading
import time

import bpy
import numpy as np
import pytest
from addon_helpers import image_of, look_until_rest, pixels, snapshot


@pytest.fixture
def live(addon, lamina, material, monkeypatch):
    """The live module, with a baked, live material that comes to rest at once and keeps its closures."""
    addon.baking.bake_job.bake_material(material)
    monkeypatch.setattr(addon.baking.live, "REST", 0.0)
    monkeypatch.setattr(addon.baking.live, "NOTICED", 1e9)
    material.lamina.live = True
    yield addon.baking.live
    addon.baking.live.stop()


def shown(material):
    return pixels(image_of(material.lamina.node_group))


def test_nothing_runs_while_nothing_changes(live, material):
    assert live.poll() is None and live.running() is None


def test_a_changed_layer_is_shown_in_the_same_nodes(addon, lamina, live, material):
    group = material.lamina.node_group
    nodes, before = {node.name for node in group.nodes}, shown(material)
    closures = addon.nodes.node_group.closures(material)
    material.lamina.layers[0].tau = 2.5
    seen = look_until_rest(live)
    assert live.WORKING in seen and addon.baking.bake_job.state(material) == "fresh"
    assert {node.name for node in group.nodes} == nodes and material.lamina.node_group == group
    expected = lamina.bake(addon.editing.stack_io.to_stack(material), "preview", closures=closures).image()
    assert np.array_equal(shown(material)[: len(expected)], expected)
    assert not np.array_equal(shown(material), before)
    assert material.lamina.result.quality == "preview"
    assert len(bpy.data.images) == 1 and image_of(group).packed_file is not None
    assert image_of(group).name == f"Lamina {material.name}"


def test_a_callback_only_takes_note(live, material):
    before = snapshot(material)
    for step in range(100):
        material.lamina.layers[0].tau = 1.0 + 0.01 * step
    assert live.running() is None and snapshot(material) == before
    look_until_rest(live)
    assert snapshot(material) != before


@pytest.mark.parametrize("name, value", [
    ("albedo", (0.1, 0.2, 0.3)), ("tau", 3.0), ("g", 0.1), ("phase", "rayleigh"), ("infinite", True),
    ("varying", True), ("tau_per_channel", True), ("mode", "coefficients"),
])  # fmt: skip
def test_every_property_of_a_layer_is_followed(addon, live, material, name, value):
    setattr(material.lamina.layers[0], name, value)
    look_until_rest(live)
    assert addon.baking.bake_job.state(material) == "fresh"


@pytest.mark.parametrize("name, value", [("kind", "none"), ("kind", "half-space"), ("reflectance", (0.9, 0.1, 0.1))])
def test_the_base_is_followed(addon, live, material, name, value):
    setattr(material.lamina.base, name, value)
    look_until_rest(live)
    assert addon.baking.bake_job.state(material) == "fresh"


def test_the_largest_thickness_is_followed_in_the_same_nodes(addon, live, material):
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    look_until_rest(live)
    group = material.lamina.node_group
    nodes = [node.as_pointer() for node in group.nodes]
    layer.tau = 3.0
    look_until_rest(live)
    assert [node.as_pointer() for node in group.nodes] == nodes
    assert addon.nodes.node_group.group_nodes(material)[0].inputs["Thickness"].default_value == pytest.approx(3.0)

    def constants():
        return {node.label: [socket.default_value for socket in node.inputs] for node in group.nodes
                if node.type == "MATH"}  # fmt: skip

    updated = constants()
    lut = addon.baking.bake_job.bake_material(material)
    assert [node.as_pointer() for node in group.nodes] != nodes, "a bake that was asked for draws anew"
    assert lut.header["axes"]["tau"]["count"] > 1 and constants() == updated


def test_layers_that_come_and_go_are_followed(addon, live, material):
    edits = addon.editing.layer_list
    for edit in (edits.add_layer, edits.duplicate_layer, edits.remove_layer):
        edit(material)
        look_until_rest(live)
        assert addon.baking.bake_job.state(material) == "fresh"
    material.lamina.layers[0].g = 0.3
    look_until_rest(live)
    assert addon.editing.layer_list.move_layer(material, "DOWN") or addon.editing.layer_list.move_layer(material, "UP")
    look_until_rest(live)
    assert addon.baking.bake_job.state(material) == "fresh"


def test_the_newest_state_wins(addon, lamina, live, material, monkeypatch):
    begun, go, baked = threading.Event(), threading.Event(), []
    real = lamina.bake

    def slow(stack, **arguments):
        baked.append(stack.to_json()["layers"][0]["tau"])
        begun.set()
        go.wait(10.0)
        return real(stack, **arguments)

    monkeypatch.setattr(lamina, "bake", slow)
    material.lamina.layers[0].tau = 2.0
    live.poll()
    assert begun.wait(10.0)
    for tau in (3.0, 4.0, 5.0):
        material.lamina.layers[0].tau = tau
        assert live.poll() == live.WORKING
    go.set()
    look_until_rest(live)
    assert baked == [2.0, 5.0] and addon.baking.bake_job.state(material) == "fresh"


def test_a_long_bake_of_an_old_state_is_given_up(addon, lamina, live, material, monkeypatch):
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
    monkeypatch.setattr(live, "PATIENCE", 0.0)
    material.lamina.layers[0].tau = 2.0
    live.poll()
    assert live.poll() == live.WORKING and snapshot(material) == before
    material.lamina.layers[0].tau = 5.0
    look_until_rest(live)
    assert addon.baking.bake_job.state(material) == "fresh" and addon.baking.bake_job.failure(material) == ""
    assert seen == [None, live.NODES, None], "what follows a bake that was given up leaves something out, till rest"


def test_an_error_is_shown_and_spoils_nothing(addon, lamina, live, material, monkeypatch):
    before, real = snapshot(material), lamina.bake

    def bake(stack, **arguments):
        raise lamina.SolveError("layers[0]: did not converge, energy error 1e-3")

    monkeypatch.setattr(lamina, "bake", bake)
    material.lamina.layers[0].tau = 2.0
    look_until_rest(live)
    assert addon.baking.bake_job.failure(material).startswith("Layer 1 “Dust”: did not converge")
    assert snapshot(material) == before
    monkeypatch.setattr(lamina, "bake", real)
    material.lamina.layers[0].tau = 2.1
    look_until_rest(live)
    assert addon.baking.bake_job.failure(material) == "" and addon.baking.bake_job.state(material) == "fresh"


def test_layers_that_cannot_be_baked_are_told(addon, live, material):
    before = snapshot(material)
    addon.editing.layer_list.add_layer(material)
    look_until_rest(live)
    before = snapshot(material)
    material.lamina.layers[0].infinite = material.lamina.layers[0].varying = True
    look_until_rest(live)
    assert addon.baking.bake_job.failure(material) and snapshot(material) == before


def test_a_slow_stack_is_coarse_while_edited_and_whole_at_rest(addon, live, material, monkeypatch):
    material.lamina.layers[0].varying = True
    look_until_rest(live)
    monkeypatch.setattr(live, "SLOW", 0.0)
    strides = []
    real = live.LiveJob

    class Watched(real):
        def __init__(self, material, closures, coarse):
            strides.append(coarse.get("row_stride", 1))
            super().__init__(material, closures, coarse)

    monkeypatch.setattr(live, "LiveJob", Watched)
    material.lamina.layers[0].g = 0.2
    look_until_rest(live)
    assert strides == [live.ROW_STRIDE, 1] and addon.baking.bake_job.state(material) == "fresh"


def test_closures_are_chosen_anew_when_the_kept_ones_do_badly(addon, live, material, monkeypatch):
    kept = addon.nodes.node_group.closures(material)
    monkeypatch.setattr(live, "WORSE", 0.0)
    monkeypatch.setattr(live, "NOTICED", 0.0)
    material.lamina.layers[0].albedo = (0.99, 0.99, 0.99)
    material.lamina.layers[0].tau, material.lamina.layers[0].g = 8.0, -0.8
    chosen = []
    real = live.LiveJob

    class Watched(real):
        def __init__(self, material, closures, coarse):
            chosen.append(closures)
            if closures is None:
                monkeypatch.setattr(live, "WORSE", 1e9)
            super().__init__(material, closures, coarse)

    monkeypatch.setattr(live, "LiveJob", Watched)
    look_until_rest(live)
    assert chosen == [kept, None]


def test_turning_it_off_keeps_the_picture(addon, live, material):
    material.lamina.layers[0].tau = 2.5
    look_until_rest(live)
    before = snapshot(material)
    material.lamina.live = False
    material.lamina.layers[0].tau = 4.0
    assert live.poll() is None and snapshot(material) == before
    assert addon.baking.bake_job.state(material) == "stale" and material.lamina.result.quality == "preview"
    material.lamina.live = True
    look_until_rest(live)
    assert addon.baking.bake_job.state(material) == "fresh"


def test_a_saved_file_holds_the_last_picture(addon, live, material, tmp_path):
    material.use_fake_user = True
    material.lamina.layers[0].tau = 2.5
    while live.poll() == live.WORKING:
        time.sleep(0.001)
    last, name = shown(material), image_of(material.lamina.node_group).name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "live.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "live.blend"))
    assert np.array_equal(pixels(bpy.data.images[name]), last)
    material = bpy.data.materials["Bronze"]
    material.lamina.layers[0].tau = 3.5
    look_until_rest(live)
    assert addon.baking.bake_job.state(material) == "fresh", "Live goes on in a reopened file"


@pytest.mark.parametrize("way", ["new file", "material removed", "stack removed", "baked"])
def test_what_ends_a_running_job(addon, live, material, call, way):
    material.lamina.layers[0].tau = 2.0
    live.poll()
    if way == "new file":
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    elif way == "material removed":
        bpy.data.materials.remove(material)
    elif way == "stack removed":
        addon.editing.layer_list.remove_stack(material)
    else:
        assert call(bpy.ops.lamina.bake, material) == {"FINISHED"}
        assert live.running() is None
    look_until_rest(live)
    assert live.running() is None
    if way == "stack removed":
        assert material.lamina.node_group is None


def test_materials_that_are_not_live_are_left_alone(addon, live, material):
    other = material.copy()
    other.lamina.live = False
    other.lamina.layers[0].tau = 7.0
    assert live.poll() is None and addon.baking.bake_job.state(other) == "stale"


def test_a_copy_gets_its_own_group(addon, live, material):
    other = material.copy()
    other.lamina.layers[0].tau = 7.0
    before = snapshot(material)
    look_until_rest(live)
    assert other.lamina.node_group != material.lamina.node_group and snapshot(material) == before

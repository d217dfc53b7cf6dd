# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking and shadow linking of lamps, against renders of Cycles."""

import bpy
import numpy as np
import pytest
from lit_patch import PLACE, irradiance_in_cycles, lit_scene


def linked(linking):
    """A collection of objects: {name of an object: state, or state of a collection below: such a dictionary}."""
    found = bpy.data.collections.new("Linked")
    for name, state in linking.items():
        if isinstance(state, dict):
            found.children.link(linked(state))
            found.collection_children[-1].light_linking.link_state = name
        else:
            found.objects.link(bpy.data.objects.get(name) or bpy.data.objects.new(name, None))
            found.collection_objects[-1].light_linking.link_state = state
    return found


def shade():
    """A square between the lamp and the origin, larger than the patch and its light."""
    mesh = bpy.data.meshes.new("Shade")
    mesh.from_pydata([(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], [], [(0, 1, 2, 3)])
    obj = bpy.data.objects.new("Shade", mesh)
    obj.location, obj.rotation_euler = 0.7 * PLACE, PLACE.to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(obj)
    return obj


def seen_of(patch):
    """(lamps, occluders) of the patch."""
    from bl_ext.user_default.lamina.base import native, rendered
    from bl_ext.user_default.lamina.interior import around, body, lamps

    scene = bpy.context.scene
    bpy.context.view_layer.update()
    frame = body.frame_of(patch, scene)

    def read(depsgraph):
        found = lamps.rendered(depsgraph, frame, patch)
        others, found = around.occluders(depsgraph, patch, frame, native.require(), found)
        return found, others

    return rendered.visit(scene, bpy.context.view_layer, read)


def takes(others, lamp):
    """Whether each face takes light of the lamp."""
    return others.shadows >> np.uint64(lamp.numbers.get("linking", 0)) & np.uint64(1) == 1


@pytest.mark.parametrize(("linking", "shines"), [
    ({"Patch": "INCLUDE"}, True), ({"Patch": "EXCLUDE"}, False), ({"Other": "INCLUDE"}, False),
    ({"Other": "EXCLUDE"}, True), ({"Other": "INCLUDE", "Patch": "EXCLUDE"}, False), ({}, None),
    ({"EXCLUDE": {"Patch": "INCLUDE"}}, False), ({"INCLUDE": {"Patch": "INCLUDE"}}, True),
    ({"Patch": "INCLUDE", "EXCLUDE": {"Patch": "INCLUDE"}}, True), ({"INCLUDE": {"Patch": "EXCLUDE"}}, True),
    ({"Patch": "EXCLUDE", "INCLUDE": {"Patch": "INCLUDE"}}, False),
    ({"INCLUDE": {"EXCLUDE": {"Patch": "INCLUDE"}}}, True), ({"EXCLUDE": {"INCLUDE": {"Patch": "INCLUDE"}}}, False),
])  # fmt: skip
def test_light_linking_is_that_of_cycles(addon, lamina, linking, shines):
    from bl_ext.user_default.lamina.interior import float_render

    scene = lit_scene("SUN")
    found = {}

    def link():
        scene.objects["SUN"].light_linking.receiver_collection = linked(linking)
        found["lamps"] = seen_of(scene.objects["Patch"])[0]

    irradiance = irradiance_in_cycles(float_render, scene, link)
    assert bool(found["lamps"]) == (irradiance > 0.1)
    assert shines is None or bool(found["lamps"]) == shines


BOTH = {"Patch": "INCLUDE", "Shade": "INCLUDE"}


@pytest.mark.parametrize(("blockers", "shines"), [
    (None, False), (BOTH, False), ({"Patch": "INCLUDE"}, True), ({"Shade": "EXCLUDE"}, True),
    ({"Other": "EXCLUDE"}, False), ({"Other": "INCLUDE", "Patch": "INCLUDE"}, True), ({}, False),
    ({"Patch": "INCLUDE", "Shade": "EXCLUDE"}, True), ({"EXCLUDE": {"Shade": "INCLUDE"}}, True),
    ({"INCLUDE": BOTH}, False), ({**BOTH, "EXCLUDE": {"Shade": "INCLUDE"}}, False),
    ({"Shade": "EXCLUDE", "INCLUDE": BOTH}, True), ({"INCLUDE": {"EXCLUDE": BOTH}}, False),
])  # fmt: skip
@pytest.mark.parametrize("name", ["SUN", "AREA"])
def test_shadow_linking_is_that_of_cycles(addon, lamina, name, blockers, shines):
    from bl_ext.user_default.lamina.interior import float_render

    scene = lit_scene(name)
    scene.cycles.max_bounces = 0
    found = {}

    def link():
        shade()
        if blockers is not None:
            scene.objects[name].light_linking.blocker_collection = linked(blockers)
        found["lamps"], found["others"] = seen_of(scene.objects["Patch"])

    irradiance = irradiance_in_cycles(float_render, scene, link)
    assert (irradiance > 0.1) == shines and len(found["others"].triangles) == 2
    assert (takes(found["others"], found["lamps"][0]) != shines).all()


def test_an_object_must_cast_shadows_of_its_lamps(addon, lamina):
    """In Cycles a medium that casts no shadows of a lamp shows none of its light: the lamp's rays see no end of it."""
    scene = lit_scene("SUN")
    patch = shade()
    scene.objects["SUN"].light_linking.blocker_collection = linked({"Other": "INCLUDE"})
    with pytest.raises(ValueError, match="Shade casts no shadows of the light of SUN: include Shade in"):
        seen_of(patch)
    scene.objects["SUN"].light_linking.receiver_collection = linked({"Shade": "EXCLUDE"})
    assert seen_of(patch)[0] == []


@pytest.mark.parametrize("listed", [
    {"Shade": "EXCLUDE"}, {"Instance": "EXCLUDE"}, {"Instance": "EXCLUDE", "Shade": "INCLUDE", "Patch": "INCLUDE"},
    {"Instance": "INCLUDE", "Shade": "EXCLUDE", "Patch": "INCLUDE"}, {"Patch": "INCLUDE"}, None,
])  # fmt: skip
@pytest.mark.parametrize("other", [None, {"Instance": "EXCLUDE"}, {"Instance": "INCLUDE", "Patch": "INCLUDE"}])
def test_linking_of_instances_is_that_of_cycles(addon, lamina, listed, other):
    """An instancer that any lamp of the scene lists stands for what it shows."""
    from bl_ext.user_default.lamina.interior import float_render

    scene = lit_scene("SUN")
    found = {}

    def link():
        source, instance = bpy.data.collections.new("Source"), bpy.data.objects.new("Instance", None)
        source.objects.link(shade())
        scene.collection.objects.unlink(bpy.data.objects["Shade"])
        instance.instance_type, instance.instance_collection = "COLLECTION", source
        dim = bpy.data.objects.new("Dim", bpy.data.lights.new("Dim", "SUN"))
        dim.data.energy = 1e-9
        for one in (instance, dim):
            scene.collection.objects.link(one)
        for name, states in (("SUN", listed), ("Dim", other)):
            if states is not None:
                scene.objects[name].light_linking.blocker_collection = linked(states)
        found["lamps"], found["others"] = seen_of(scene.objects["Patch"])

    irradiance = irradiance_in_cycles(float_render, scene, link)
    sun = next(one for one in found["lamps"] if one.name == "SUN")
    assert (takes(found["others"], sun) == (irradiance < 0.1)).all()


def test_too_many_linkings(addon, lamina):
    patch, scene = lit_scene("SUN") and shade(), bpy.context.scene
    for number in range(64):
        lamp = bpy.data.objects.new(f"Lamp {number}", bpy.data.lights.new("Lamp", "POINT"))
        scene.collection.objects.link(lamp)
        lamp.light_linking.blocker_collection = linked({f"Other {number}": "EXCLUDE"})
    other = bpy.data.objects.new("Wall", patch.data)
    scene.collection.objects.link(other)
    with pytest.raises(ValueError, match="have 65 different light linkings: must be at most 64"):
        seen_of(patch)
    bpy.data.objects.remove(lamp)
    lamps, others = seen_of(patch)
    assert sorted(one.numbers["linking"] for one in lamps) == list(range(64)) and takes(others, lamps[5]).all()

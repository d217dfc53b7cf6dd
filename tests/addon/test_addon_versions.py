# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between the versions of Blender from 4.2 on."""

import ast
import warnings

import bpy
import pytest
from own_blender import ROOT

SWITCH = "addon/nodes/node_tree.py"  # reads the version first; demo_scenes/node_tree.py is a link to it


def test_use_nodes_is_touched_in_one_place_alone():
    """Blender 5 warns whenever `use_nodes` is read or set, and Blender 6 will not have it."""
    touched = set()
    for folder in ("addon", "demo_scenes", "tests", "bench", "study"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            if any(isinstance(node, ast.Attribute) and node.attr == "use_nodes" for node in ast.walk(tree)):
                touched.add(str(path.resolve().relative_to(ROOT.resolve())))
    assert touched == {SWITCH}


@pytest.mark.parametrize("kind", ["material", "world", "sun"])
def test_asking_for_nodes_does_not_warn(addon, kind):
    """From Blender 5.0 on a switch that no longer switches warns when it is touched."""
    owner = {"material": lambda: bpy.data.materials.new(kind), "world": lambda: bpy.data.worlds.new(kind),
             "sun": lambda: bpy.data.lights.new(kind, "SUN")}[kind]()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tree = addon.nodes.node_tree.of(owner)
        assert addon.nodes.node_tree.is_on(owner)
    assert tree == owner.node_tree and len(tree.nodes) >= 2

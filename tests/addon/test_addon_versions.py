# SPDX-License-Identifier: GPL-3.0-or-later
"""What the versions of Blender from 4.2 on do not have in common."""

import ast

from conftest import ROOT

SWITCHES = {"addon/nodes/graph.py", "demo_scenes/node_tree.py"}  # each asks for the version first


def test_use_nodes_is_touched_in_one_place_alone():
    """Blender 5 warns whenever `use_nodes` is read or set, and Blender 6 will not have it."""
    touched = set()
    for folder in ("addon", "demo_scenes", "tests", "bench", "study"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            if any(isinstance(node, ast.Attribute) and node.attr == "use_nodes" for node in ast.walk(tree)):
                touched.add(str(path.relative_to(ROOT)))
    assert touched == SWITCHES

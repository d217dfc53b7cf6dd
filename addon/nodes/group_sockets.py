# SPDX-License-Identifier: GPL-3.0-or-later
"""The sockets of a material's group: the surface's normal, the thickness of the varying layer, the coverage
of the varying interface, and the values of the base that the table leaves open.

A rebuild adds and removes sockets and changes their defaults. A value that the artist has set stays; a value
that is still the default follows the new default.
"""

import bpy

from ..kinds.bases import PrincipledBase
from ..kinds.table import BASE_WEIGHT, THROWN_BACK, Strip, strips_of
from . import base_graph, principled, side_graph, sparkle_graph
from .graph import rgba

COVERAGE, TANGENT = "Coverage", principled.TANGENT
LARGEST = 1.0e6  # the panel's largest optical thickness

_COLOR, _NUMBER, _SHADER = "NodeSocketColor", "NodeSocketFloat", "NodeSocketShader"

# (name, type, description) of each input that a group may have, from the top.
INPUTS = (
    ("Normal", "NodeSocketVector", "Normal map or bump; empty: the surface's own normal"),
    (TANGENT, "NodeSocketVector",
     "Direction of brushing, such as that of a Tangent node; empty: along u of the active UV map"),
    (side_graph.FRONT, _NUMBER, "Optical thickness of the varying layer, from 0 to what was baked"),
    (side_graph.BACK, _NUMBER,
     "Optical thickness of the varying layer on back faces; below 0: as on front faces"),
    (COVERAGE, _NUMBER, "Share of the surface that has the film of the varying interface, from 0 to 1"),
    ("Base Color", _COLOR, "Color of the base, linear; what the layers do to it is exact"),
    ("Metallic", _NUMBER, "0 is a dielectric base, 1 is a metal"),
    ("Roughness", _NUMBER, "Microfacet roughness of the base"),
    (base_graph.SHADER, _SHADER, "The shader below the layers"),
    (base_graph.REFLECTANCE, _COLOR,
     "Mean reflectance of the shader below: its color, or the mean of its colors"),
    (sparkle_graph.SPARKLE, _NUMBER, "Share of the flakes' light that single flakes throw: 0 is none, 1 all"),
    (sparkle_graph.SIZE, _NUMBER, "Distance between single flakes in the world"),
    (sparkle_graph.DISTANCE, _NUMBER,
     "Distance from the camera beyond which the sparkle fades: a flake is then as wide as a pixel"),
)
# Lengths in metres: flakes of 0.5 mm are as wide as a pixel at this distance, through a lens of 50 mm, in a
# picture 1920 pixels wide.
OF_SPARKLE = {sparkle_graph.SPARKLE: 0.0, sparkle_graph.SIZE: 5e-4, sparkle_graph.DISTANCE: 1.3}


def of_table(lut):
    """{name: default} of the coverage, the tangent, the sparkle and the inputs that describe the base of
    `lut`, where it has them; the default is None for a shader and for the tangent."""
    coverage = {} if lut.uncovered is None else {COVERAGE: 1.0}
    tangent = {TANGENT: None} if "azimuth" in lut.header["axes"] else {}
    sparkle = OF_SPARKLE if sparkle_graph.is_offered(lut) else {}
    return coverage | tangent | sparkle | _of_base(lut)


def _of_base(lut):
    strips, base = strips_of(lut.header), lut.header["stack"]["base"]
    if Strip(role=BASE_WEIGHT) in strips:
        return {base_graph.SHADER: None, base_graph.REFLECTANCE: rgba(base["reflectance"])}
    if base is not None and base["kind"] == PrincipledBase.kind:
        return {principled.SOCKETS[name]: base_graph.value(name, base[name])
                for name in base.get("inputs", ())}
    return {"Base Color": rgba(base["reflectance"])} if Strip(role=THROWN_BACK) in strips else {}


def add_missing(group, tau, base):
    """Add the missing sockets for a table of largest thickness `tau`, or None, and other inputs `base`, see
    of_table. Returns the names of the added inputs."""
    if "Shader" not in named(group, "OUTPUT"):
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type=_SHADER)
    wanted = {"Normal": None, **base}
    if tau is not None:
        wanted |= {side_graph.FRONT: min(tau, LARGEST), side_graph.BACK: side_graph.AS_FRONT}
    added = []
    for name, kind, description in INPUTS:
        if name not in wanted or name in named(group, "INPUT"):
            continue
        socket = group.interface.new_socket(name, in_out="INPUT", socket_type=kind, description=description)
        if name in ("Normal", TANGENT):
            socket.hide_value = True
        if wanted[name] is not None:
            socket.default_value = wanted[name]
        if name in (COVERAGE, sparkle_graph.SPARKLE, "Metallic", "Roughness"):
            socket.subtype, socket.min_value, socket.max_value = "FACTOR", 0.0, 1.0
        if name in (sparkle_graph.SIZE, sparkle_graph.DISTANCE):
            socket.subtype, socket.min_value = "DISTANCE", 1e-6
        added.append(name)
    return added


def remove(group, names):
    """Remove these inputs."""
    for name in names:
        group.interface.remove(named(group, "INPUT")[name])


def settle(group, tau, base):
    """Ranges and defaults of the sockets for thickness. Removes the inputs that the table does not have."""
    sockets = named(group, "INPUT")
    unwanted = {name for name, *_ in INPUTS} - {"Normal", *base}
    for name, lowest in ((side_graph.FRONT, 0.0), (side_graph.BACK, side_graph.AS_FRONT)):
        if tau is not None and name in sockets:
            socket = sockets[name]
            socket.min_value, socket.max_value = lowest, min(tau, LARGEST)
            socket.default_value = lowest if lowest < 0.0 else socket.max_value
            unwanted.discard(name)
    remove(group, unwanted & set(sockets))


def follow_thickness(group, old, new):
    """A new Thickness input starts at the baked maximum. An input at the old maximum follows a new maximum;
    other values are kept."""
    if new is None:
        return
    for socket in _used(group, side_graph.FRONT):
        untouched = old is None or old < 0.0 or abs(socket.default_value - old) <= 1.0e-6 * old
        if untouched and not socket.is_linked:
            socket.default_value = min(new, LARGEST)


def follow_base(group, base, added=()):
    """Inputs of the base that were `added`, or that still have the old default, get the new default."""
    for name, value in base.items():
        if value is None:
            continue
        socket = named(group, "INPUT")[name]
        old, socket.default_value = _plain(socket.default_value), value
        for given in _used(group, name):
            if not given.is_linked and (name in added or _plain(given.default_value) == old):
                given.default_value = value


def _used(group, name):
    """The sockets of this input, one for each node with the group."""
    return [node.inputs[name] for node in nodes_with(group) if name in node.inputs]


def nodes_with(group):
    """The nodes that use `group`, in all materials and in groups of the artist."""
    trees = [one.node_tree for one in bpy.data.materials if one.node_tree]
    return [node for tree in (*trees, *bpy.data.node_groups) for node in tree.nodes
            if node.type == "GROUP" and node.node_tree == group]


def named(group, in_out):
    """{name: interface socket} of the group's sockets, in_out "INPUT" or "OUTPUT"."""
    return {item.name: item for item in group.interface.items_tree
            if item.item_type == "SOCKET" and item.in_out == in_out}


def _plain(value):
    return tuple(value) if hasattr(value, "__len__") else value

# SPDX-License-Identifier: GPL-3.0-or-later
"""The bounces of a scene's light paths that a portal needs for the scatterings in its volume.

Cycles ends a path after the scene's number of volume bounces, and after the total number of bounces. The last
scattering still sees the lamps. The view's entry into the volume is a bounce as well. The light of missing
scatterings is lost."""

from ..nodes import node_group

_WORDS = {
    "volume_bounces": "volume bounces",
    "max_bounces": "bounces in total",
    "glossy_bounces": "glossy bounces",
    "transmission_bounces": "transmission bounces",
}
AT_BOUNDARY = 32  # reflections and refractions of light in a body


def needed(material):
    """{setting of Cycles: number of bounces that the lateral nodes of `material` need}."""
    scatterings = material.lamina.lateral_scatterings
    found = {"volume_bounces": max(scatterings - 1, 0), "max_bounces": scatterings}
    if material.lamina.lateral_shown == "VOLUME":
        found |= {"glossy_bounces": AT_BOUNDARY, "transmission_bounces": AT_BOUNDARY}
    return found


def shortage(scene, material):
    """One sentence if the scene has fewer bounces than the material needs, otherwise ''. A material whose
    lateral volume is not linked needs none."""
    wanted = _missing(scene, material)
    if not wanted:
        return ""
    has = " and ".join(f"{getattr(scene.cycles, name)} {_WORDS[name]}" for name in wanted)
    needs = " and ".join(str(count) for count in wanted.values())
    return f"Too dark: the scene allows {has}, the material needs {needs} (Render > Light Paths)"


def provide(scene, material):
    """Raise the scene's bounces to what the material needs. Returns one sentence on what was raised, or
    ''."""
    wanted = _missing(scene, material) if scene.is_editable else {}
    raised = [f"{_WORDS[name]} from {getattr(scene.cycles, name)} to {count}"
              for name, count in wanted.items()]
    for name, count in wanted.items():
        setattr(scene.cycles, name, count)
    return f"Raised the scene's {' and '.join(raised)}" if raised else ""


def _missing(scene, material):
    """What of `needed` the scene does not have."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None or not _is_linked(material):
        return {}
    return {name: count for name, count in needed(material).items() if getattr(cycles, name) < count}


def _is_linked(material):
    """True if the volume of the lateral nodes is in use."""
    nodes = node_group.group_nodes(material, material.lamina.lateral_group)
    sockets = [socket for node in nodes for socket in node.outputs]
    return any(socket.name == node_group.VOLUME and socket.is_linked for socket in sockets)

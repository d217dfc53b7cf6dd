# SPDX-License-Identifier: GPL-3.0-or-later
"""The bounces of a scene's light paths that a portal needs for the scatterings in its volume.

Cycles ends a path after the scene's number of volume bounces, and after the total number of bounces. The last
scattering still sees the lamps. The view's entry into the volume is a bounce as well. The light of missing
scatterings is lost."""

from ..nodes import node_group


def needed(material):
    """(volume bounces, bounces in total) that the lateral nodes of `material` need."""
    scatterings = material.lamina.lateral_scatterings
    return max(scatterings - 1, 0), scatterings


def shortage(scene, material):
    """One sentence if the scene has fewer bounces than the material needs, otherwise ''. A material whose
    lateral volume is not linked needs none."""
    volume, total = needed(material)
    cycles = getattr(scene, "cycles", None)
    if cycles is None or not _is_linked(material):
        return ""
    if cycles.volume_bounces >= volume and cycles.max_bounces >= total:
        return ""
    return (f"Too dark: the scene allows {cycles.volume_bounces} volume bounces and {cycles.max_bounces} in "
            f"total, the material needs {volume} and {total} (Render > Light Paths)")


def provide(scene, material):
    """Raise the scene's bounces to what the material needs. Returns one sentence on what was raised, or
    ''."""
    if not shortage(scene, material) or not scene.is_editable:
        return ""
    volume, total = needed(material)
    raised = []
    wanted = {"volume_bounces": ("volume bounces", volume), "max_bounces": ("bounces", total)}
    for name, (words, count) in wanted.items():
        found = getattr(scene.cycles, name)
        if found < count:
            setattr(scene.cycles, name, count)
            raised.append(f"{words} from {found} to {count}")
    return f"Raised the scene's {' and '.join(raised)}"


def _is_linked(material):
    """True if the volume of the lateral nodes is in use."""
    nodes = node_group.group_nodes(material, material.lamina.lateral_group)
    sockets = [socket for node in nodes for socket in node.outputs]
    return any(socket.name == node_group.VOLUME and socket.is_linked for socket in sockets)

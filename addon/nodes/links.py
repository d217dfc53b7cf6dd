# SPDX-License-Identifier: GPL-3.0-or-later
"""Questions about the links of a node tree, and links that may be muted."""

from typing import NamedTuple

import bpy


class Feed(NamedTuple):
    """An output socket that is linked to an input, and whether the link is muted."""

    socket: bpy.types.NodeSocket
    muted: bool = False


def feed(target):
    """What is linked to the input socket `target`, muted or not: a Feed, or None."""
    for link in target.links:
        return Feed(link.from_socket, link.is_muted)
    return None


def source(target):
    """The output socket whose value `target`, an input socket, receives, through reroutes; None if nothing
    does. A muted link carries no value."""
    passed = set()
    while True:
        found = feed(target)
        if found is None or found.muted or found.socket.node.name in passed:
            return None
        if found.socket.node.type != "REROUTE":
            return found.socket
        passed.add(found.socket.node.name)
        target = found.socket.node.inputs[0]


def connect(given, target):
    """Link the Feed `given` to the input socket `target`."""
    link = target.id_data.links.new(given.socket, target)
    if given.muted:
        link.is_muted = True


def upstream(node):
    """`node` and all nodes that feed it, directly or not."""
    waiting, seen = [node], {node.name}
    while waiting:
        node = waiting.pop()
        yield node
        for socket in node.inputs:
            for link in socket.links if socket.is_linked else ():  # is_linked is much faster
                if link.from_node.name not in seen:
                    seen.add(link.from_node.name)
                    waiting.append(link.from_node)

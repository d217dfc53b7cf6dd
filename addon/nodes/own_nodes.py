# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes of a material's tree that Lamina has made. A mark on each node says so."""

_MARK = "lamina_made"  # its value is the node's name when it was made


def mark(node):
    """Mark `node` as made by Lamina. Returns it."""
    node[_MARK] = node.name
    return node


def is_marked(node):
    """True for a node that Lamina has marked, and False for the artist's copy of the node."""
    name = node.get(_MARK)
    # A copy has another name than the marked node. If no node has the name, the marked node was renamed.
    return name is not None and (name == node.name or name not in node.id_data.nodes)


def names_of(material):
    """The names of the nodes that Lamina has made: marked ones, and nodes with the material's groups."""
    tree, groups = material.node_tree, _groups(material)
    return {node.name for node in (tree.nodes if tree else ())
            if is_marked(node) or (node.type == "GROUP" and node.node_tree in groups)}


def around(material, group=None):
    """The nodes of the artist's groups that have this one of the material's groups inside, as after Make
    Group; without a `group`, those that have any."""
    nodes, own = material.node_tree.nodes if material.node_tree else (), _groups(material)
    wanted = [group] if group else own
    return [node for node in nodes
            if node.type == "GROUP" and node.node_tree not in own and _holds(node.node_tree, wanted)]


def _groups(material):
    return [one for one in (material.lamina.node_group, material.lamina.lateral_group) if one]


def _holds(tree, groups):
    inside = [node.node_tree for node in tree.nodes if node.type == "GROUP"] if tree else []
    return any(one in groups or _holds(one, groups) for one in inside)


def unmark_all(tree):
    """Remove the marks of all nodes."""
    for node in tree.nodes:
        if _MARK in node:
            del node[_MARK]

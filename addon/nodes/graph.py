# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers that build a shader graph: nodes in labelled frames, which `arrange` lays out."""

from .expression import Value

NEVER_ZERO = (0.61e-4, 1.07e-4, 1.57e-4)  # added to a tangent, which a mesh without a UV map lacks
COLUMN = 190.0
ROW = 44.0  # height of a folded node
SOCKET, FRAME = 22.0, 60.0  # height of a socket, and between frames


def rgba(channels):
    """The value of a color socket, from a list of one number or of one per channel."""
    return (*(channels * 3 if len(channels) == 1 else channels), 1.0)


class Graph:
    """Adds nodes to a node tree and remembers them, so that an incomplete graph can be removed."""

    def __init__(self, tree):
        self.tree = tree
        self.created = []
        self.frame = None

    def begin_frame(self, label, colour):
        """Nodes added from now on belong to a new frame."""
        self.frame = None
        self.frame = self._new("NodeFrame", label)
        self.frame.label_size = 18
        self.frame.use_custom_color = True
        self.frame.color = colour
        self.frame.shrink = True

    def end_frame(self):
        self.frame = None

    def node(self, kind, label="", folded=True):
        node = self._new(kind, label)
        node.hide = folded
        if self.frame is not None:
            node.parent = self.frame
        return node

    def value(self, socket):
        """The number or vector of an output socket, for formulas, see expression."""
        return Value(self, socket)

    def values(self, node):
        """{name: Value} of the outputs of a node."""
        return {socket.name: Value(self, socket) for socket in node.outputs}

    def combined(self, label, *parts):
        """The vector of up to three parts, numbers or values; missing parts are 0."""
        node = self.node("ShaderNodeCombineXYZ", label)
        for target, part in zip(node.inputs, parts, strict=False):
            self.set(target, part)
        return self.value(node.outputs[0])

    def separate(self, label, color):
        """The three channels of a color."""
        node = self.node("ShaderNodeSeparateColor", label)
        self.link(color, node.inputs[0])
        return [self.value(socket) for socket in node.outputs]

    def mix(self, kind, label, share, first, second):
        """`first` at the share 0, `second` at 1. `kind`: "RGBA", "VECTOR" or "FLOAT". Cycles
        leaves the node out if the share is a fixed 0."""
        node = self.node("ShaderNodeMix", label)
        node.data_type = kind
        end = {"RGBA": "Color", "VECTOR": "Vector", "FLOAT": "Float"}[kind]
        sockets = {socket.identifier: socket for socket in (*node.inputs, *node.outputs)}
        for name, value in (("Factor_Float", share), (f"A_{end}", first), (f"B_{end}", second)):
            self.set(sockets[name], value)
        return self.value(sockets[f"Result_{end}"])

    def mix_shaders(self, label, factor, first, second):
        """The shader `first` at the factor 0, and `second` at 1. `factor`: a number, a value or a socket."""
        node = self.node("ShaderNodeMixShader", label)
        for target, given in zip(node.inputs, (factor, first, second), strict=True):
            if given is not None:
                self.set(target, given)
        return node.outputs[0]

    def weighted_shader(self, label, weight, shader):
        """The shader times `weight`, from 0 to 1: its mixture with no shader."""
        return self.mix_shaders(label, weight, None, shader)

    def add_shaders(self, label, first, second):
        """The sum of two shaders."""
        node = self.node("ShaderNodeAddShader", label)
        self.link(first, node.inputs[0])
        self.link(second, node.inputs[1])
        return node.outputs[0]

    def link(self, output, target):
        """Link a value or an output socket to `target`."""
        self.tree.links.new(output.socket if isinstance(output, Value) else output, target)

    def set(self, target, value):
        """Link a value or an output socket to `target`, or set its number."""
        if isinstance(value, Value) or hasattr(value, "is_output"):
            self.link(value, target)
        else:
            target.default_value = value

    def arrange(self, right=0.0, top=0.0):
        """Lay out the added nodes below `top`. A node stands to the left of all nodes that it feeds; those
        that feed none stand at `right`. Frames lie below one another, after the nodes without a frame."""
        nodes = [node for node in self.created if node.bl_idname != "NodeFrame"]
        columns, frames = _steps_to_the_end(nodes, self.tree.links), {}
        for node in nodes:
            frames.setdefault(node.parent, []).append(node)
        for frame in sorted(frames, key=lambda frame: frame is not None):
            bottoms = {}
            for node in frames[frame]:
                column = columns[node]
                node.location = right - column * COLUMN, bottoms.get(column, top)
                bottoms[column] = node.location.y - _height(node)
            top = min(bottoms.values()) - FRAME

    def remove_created(self):
        """Remove all added nodes, frames last."""
        for node in reversed(self.created):
            self.tree.nodes.remove(node)
        self.created.clear()

    def _new(self, kind, label):
        node = self.tree.nodes.new(kind)
        self.created.append(node)
        node.label = label
        node.select = False
        return node


def _steps_to_the_end(nodes, links):
    """{node: the largest number of links from the node to one that feeds none of `nodes`}."""
    own, fed = set(nodes), {node: set() for node in nodes}
    for link in links:
        if link.from_node in own and link.to_node in own:
            fed[link.from_node].add(link.to_node)
    steps = {}
    waiting = list(nodes)
    while waiting:
        node = waiting[-1]
        missing = [one for one in fed[node] if one not in steps]
        if missing:
            waiting += missing
        else:
            steps[waiting.pop()] = 1 + max((steps[one] for one in fed[node]), default=-1)
    return steps


def _height(node):
    if node.hide:
        return ROW
    return 2.0 * ROW + SOCKET * sum(not socket.hide for socket in (*node.inputs, *node.outputs))

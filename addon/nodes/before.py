# SPDX-License-Identifier: GPL-3.0-or-later
"""The material's tree before Lamina: what is kept of it, and how it is restored.

All is kept in the tree itself. A frame “Before Lamina” holds a reroute for each input of the material output
that Lamina has taken. The node that fed the input is linked to the reroute: links survive renaming, saving,
copying and undo, and the artist sees them.
"""

from . import links, node_tree, own_nodes

FRAME = "Before Lamina"
SURFACE, VOLUME = "Surface", "Volume"  # inputs of the material output

_COLOUR = (0.26, 0.26, 0.26)
_DOWN = 420.0  # distance from the layers' node down to the node that they replace
_INPUT = "lamina_input"  # of a reroute: which input of the output it stands for
_PLACE = "lamina_place"  # of the frame: where the replaced node was
_READ = "lamina_read"  # of the frame: what the layers have taken from the replaced node, as text
_OFF = "lamina_nodes_were_off"  # of the tree
_CORRECTION = "lamina_bump_map_correction"  # of the tree
_SAMPLING = "lamina_emission_sampling"  # of the tree: the material's earlier choice


def switch_nodes_on(material):
    """The node tree of `material`, which then has nodes."""
    was_on = node_tree.is_on(material)
    tree = node_tree.of(material)
    if not was_on:
        tree[_OFF] = True
    return tree


def corrects(material):
    """True if Cycles' bump map correction is on."""
    return getattr(getattr(material, "cycles", None), "use_bump_map_correction", False)


def switch_correction_off(material):
    """Switch Cycles' bump map correction off. Tilted normals of closures are not bump maps: the correction
    would darken them."""
    if corrects(material):
        material.cycles.use_bump_map_correction = False
        material.node_tree[_CORRECTION] = True


def switch_sampling_off(material):
    """Let Cycles not aim at the material's emission: a lit surface shines on others as a diffuse one would.
    The earlier choice is kept."""
    cycles, tree = getattr(material, "cycles", None), material.node_tree
    if not hasattr(cycles, "emission_sampling"):
        return
    if _SAMPLING not in tree:
        tree[_SAMPLING] = cycles.emission_sampling
    cycles.emission_sampling = "NONE"


def restore_sampling(material):
    """The material no longer emits: its emission sampling is as before, unless it was changed since."""
    earlier = material.node_tree.pop(_SAMPLING, None)
    cycles = getattr(material, "cycles", None)
    if earlier is not None and getattr(cycles, "emission_sampling", "") == "NONE":
        cycles.emission_sampling = earlier


def keep(material, target):
    """Keep what feeds `target`, an input of the material output, which Lamina is about to link.

    Nothing is kept where Lamina's own nodes feed the input, directly or through nodes of the artist."""
    tree = material.node_tree
    own = own_nodes.names_of(material).union(node.name for node in own_nodes.around(material))
    fed = links.feed(target)
    if fed is None or any(node.name in own for node in links.upstream(fed.socket.node)):
        return
    put_back(tree)  # a node that the layers replaced earlier
    reroute = _reroute(tree, target.name) or _add_reroute(tree, target)
    links.connect(fed, reroute.inputs[0])


def kept(tree, name=SURFACE):
    """The links.Feed of an input of the material output before Lamina, or None."""
    reroute = _reroute(tree, name)
    return None if reroute is None else links.feed(reroute.inputs[0])


def source(tree):
    """The output socket that fed the Surface before Lamina, behind reroutes, or None."""
    reroute = _reroute(tree, SURFACE)
    return None if reroute is None else links.source(reroute.inputs[0])


def put_aside(tree, node):
    """Move `node`, which the layers replace, down and into the frame.

    The node must feed the kept Surface. Returns its former parent and location."""
    frame, parent, place = _frame(tree), node.parent, tuple(node.location)
    frame[_PLACE] = [*place, *getattr(node, "location_absolute", place)]
    frame.parent = parent
    node.location = (place[0], place[1] - _DOWN)
    node.parent = frame
    reroute = _reroute(tree, SURFACE)
    reroute.parent = parent
    reroute.location = (place[0] + node.width + 40.0, place[1] - _DOWN - 30.0)
    reroute.parent = frame
    return parent, place


def put_back(tree):
    """Move the node that `put_aside` has moved to its place, unless the artist has taken it out of the
    frame."""
    frame, found = _frame(tree), source(tree)
    place = frame.get(_PLACE) if frame is not None else None
    if place is None:
        return
    if found is not None and found.node.parent == frame:
        node = found.node
        node.parent = frame.parent
        node.location = place[:2]
        if hasattr(node, "location_absolute") and _are_near(node.location_absolute, place[2:]):
            node.location_absolute = place[2:]  # without the rounding of a location within a frame
    del frame[_PLACE]
    frame.pop(_READ, None)


def note(tree, text):
    """Keep `text`: what the layers have taken from the node that they replace."""
    _frame(tree)[_READ] = text


def noted(tree):
    """The text of the last `note`, or ''."""
    frame = _frame(tree)
    return "" if frame is None else frame.get(_READ, "")


def restore(material):
    """Link everything as before Lamina, and remove the nodes that Lamina has made. Nodes of the artist stay;
    what was before Lamina feeds those that Lamina's nodes have fed."""
    tree = material.node_tree
    if tree is None:
        return
    own = own_nodes.names_of(material)
    restored = _restore_links(tree, own, own_nodes.around(material))
    output = tree.get_output_node("CYCLES")
    for name in (SURFACE, VOLUME):
        fed = kept(tree, name)
        if fed and output is not None and name not in restored and not output.inputs[name].links:
            links.connect(fed, output.inputs[name])
    put_back(tree)
    for name in own:
        node = tree.nodes[name]
        if node.type != "OUTPUT_MATERIAL" or not any(socket.links for socket in node.inputs):
            tree.nodes.remove(node)
    own_nodes.unmark_all(tree)  # of the artist's copies
    if tree.pop(_CORRECTION, None):
        material.cycles.use_bump_map_correction = True
    restore_sampling(material)
    if tree.pop(_OFF, None):
        node_tree.switch_off(material)


def _restore_links(tree, own, around):
    """Link the targets of Lamina's shaders, and of the artist's groups `around` them, to what was there
    before. Returns the names of the kept inputs that were used."""
    used = set()
    for node in [*(tree.nodes[name] for name in own), *around]:
        if node.type in ("REROUTE", "FRAME"):
            continue
        for socket in node.outputs:
            name = VOLUME if socket.name == VOLUME else SURFACE
            if node in around and (socket.type != "SHADER" or kept(tree, name) is None):
                continue
            for link in list(socket.links):
                fed, target = kept(tree, name), link.to_socket
                if target.node.name in own and target.node.type != "OUTPUT_MATERIAL":
                    continue
                muted = link.is_muted
                tree.links.remove(link)
                if fed is None or socket.type != "SHADER":
                    continue
                if target.node.name not in {one.name for one in links.upstream(fed.socket.node)}:
                    links.connect(links.Feed(fed.socket, fed.muted or muted), target)
                    used.add(name)
    return used


def _frame(tree):
    return next((node for node in tree.nodes if node.type == "FRAME" and own_nodes.is_marked(node)), None)


def _reroute(tree, name):
    return next((node for node in tree.nodes if node.get(_INPUT) == name and own_nodes.is_marked(node)), None)


def _add_reroute(tree, target):
    """A reroute for `target` in the frame, below the material output."""
    frame, output = _frame(tree), target.node
    if frame is None:
        frame = own_nodes.mark(tree.nodes.new("NodeFrame"))
        frame.label, frame.use_custom_color, frame.color = FRAME, True, _COLOUR
        frame.select = False
    reroute = own_nodes.mark(tree.nodes.new("NodeReroute"))
    reroute[_INPUT] = target.name
    reroute.label = f"To {target.name}"
    reroute.select = False
    reroute.location = (output.location.x, output.location.y - 240.0 - 60.0 * (target.name == VOLUME))
    reroute.parent = frame
    return reroute


def _are_near(one, other):
    return max(abs(a - b) for a, b in zip(one, other, strict=True)) < 0.01

# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a layer lies: everywhere, where dust settles, where it was not wiped off, or where an image says; a
film also in drops, puddles or fingerprints.

Choosing a place lets the layer vary, bakes the material, and feeds the input of its node group. `gather`
reads and chooses where the dust is stored, the work may run in a thread, `_finish` writes. Layers and nodes
do not change before bake and dust are known.
"""

import math
from typing import NamedTuple

import bpy

from ..baking import bake_job, update
from ..base import editable, messages, preferences, rendered, unwrap, uv_maps
from ..base.messages import RefusedError
from ..base.worker import with_uid
from ..editing import layer_list, stack_io
from ..kinds import media
from ..nodes import detail_wiring, film_pattern, film_wiring, node_group, thickness
from ..nodes.group_sockets import COVERAGE
from ..nodes.side_graph import FRONT
from ..settling import dust_job, live_dust, object_dust, wiping
from . import dusting

EVEN, SETTLED, PAINTED, IMAGE = "EVEN", "SETTLED", "PAINTED", "IMAGE"
DROPS, PUDDLES, PRINTS = film_pattern.PATTERNS
# (place, name, description)
PLACES = (
    (EVEN, "Even", "The same everywhere"),
    (SETTLED, "Settled", "Dust settles on the active object: on what faces up, and in corners and folds"),
    (PAINTED, "Painted", "A mask that you paint on the active object"),
    (IMAGE, "Image", "An image of optical thickness"),
    (DROPS, "Drops", "Drops of many sizes, with normals"),
    (PUDDLES, "Puddles", "Level water on places that are nearly level"),
    (PRINTS, "Prints", "Fingerprints at random"),
)
_OF_KIND = {"medium": (EVEN, SETTLED, PAINTED, IMAGE),
            "interface": (EVEN, SETTLED, PAINTED, DROPS, PUDDLES, PRINTS), "film": (EVEN,),
            "flakes": (EVEN, PAINTED), "fibers": (EVEN, PAINTED)}
# Inputs of the node group, for a varying layer of this kind
INPUTS = {"medium": FRONT, "flakes": FRONT, "fibers": FRONT, "interface": COVERAGE}
RANGE = 4.0  # least optical thickness up to which settled dust and images can be shown
USUAL = 1.0  # optical thickness of a layer that was never even: at 4 a layer hides all below
WITHOUT = "Select a mesh object that has this material"
_SAME = "The layer is the same everywhere"


def choices(layer):
    """The places that a layer can have."""
    return _OF_KIND[layer.kind]


def of(material, layer):
    """The place of a layer, or "" where nodes of the artist's own feed it."""
    if not layer.varying:
        return EVEN
    now = thickness.wiring(material, INPUTS[layer.kind])
    if object_dust.is_source(now):
        return SETTLED
    if now.source == "image":
        return PAINTED if layer.kind == "interface" else IMAGE
    if now.source != "value":
        return "" if now.source in ("custom", "attribute") else EVEN
    if layer.kind == "interface":
        return film_wiring.chosen(material) or EVEN
    return PAINTED if detail_wiring.mask(material) is not None else EVEN


class Choice(NamedTuple):
    """A place for the layer with this index, on the object with this session_uid, if any."""

    place: str
    index: int
    uid: int | None


def _choice(context, material, place):
    uid = None if context.object is None else context.object.session_uid
    return Choice(place, material.lamina.active_index, uid)


def is_quick(material, place):
    """True if this place of the active layer needs neither a bake nor dust."""
    layer = layer_list.active_layer(material)
    return layer is None or place == EVEN or place != SETTLED and not _needs_bake(material, layer, place)


def put(context, material, place, progress=None, cancel=None):
    """Give the active layer of `material` a place. Blocks. Returns a sentence for the artist.

    Links of the artist's own nodes to the input are replaced; the nodes stay. Raises RefusedError,
    StackError, lamina's Cancelled, NativeMissingError; then layers and nodes are as before."""
    choice = _choice(context, material, place)
    gathered = gather(context, material, choice)
    told, stopped = progress or (lambda *_: None), cancel or (lambda: False)
    with dusting.restored(gathered.storage):
        found = dusting.work(gathered, preferences.threads(), told, stopped)
        return _finish(material, choice, gathered, found)


class PlaceJob(dusting.DustingJob):
    """The bake and the settling in a thread."""

    def __init__(self, context, material, place):
        self.uid, self.choice = material.session_uid, _choice(context, material, place)
        super().__init__(gather(context, material, self.choice), preferences.threads())

    def written(self):
        material = with_uid(bpy.data.materials, self.uid)
        if material is None:
            return None
        return _finish(material, self.choice, self.gathered, self.result)


def start(context, material, place):
    """Start in the background, as dust_job.start does. Raises as `put` does, before it starts."""
    job = PlaceJob(context, material, place)
    with dusting.restored(job.gathered.storage):
        return dust_job.take(job)


def gather(context, material, choice):
    """What is to be done: a dusting.Gathered. Raises RefusedError, StackError."""
    layer, place = _layer(material, choice), choice.place
    if place not in choices(layer):
        raise RefusedError(f"A layer of this kind has no place “{place.capitalize()}”")
    obj, tasks, bakes, storage = _object(choice), [], {}, []
    if place != EVEN:
        if obj is None or all(slot.material != material for slot in obj.material_slots):
            raise RefusedError(WITHOUT)
        if obj.type != "MESH":
            raise RefusedError(rendered.to_convert(obj))
        _check_mesh(obj, layer, place)
        problem = node_group.unreachable(material)
        if problem:
            raise RefusedError(problem)
        if _needs_bake(material, layer, place):
            bakes[material.session_uid] = _bake(material, choice)
    if place == SETTLED:
        live_dust.leave(obj)
        with dusting.restored(storage):
            storage.append(dusting.choose_storage(context, obj))
            tasks = object_dust.gather_all(context, [obj])
    return dusting.Gathered(tasks, bakes, cover=lambda material: _vary(material, choice), storage=storage)


def _check_mesh(obj, layer, place):
    """Raises RefusedError, before anything changes, if the mesh cannot hold what this place needs."""
    if place == PAINTED and layer.kind != "interface":
        wiping.checked(obj)
    elif place in (PAINTED, IMAGE) and uv_maps.find(obj.data, "") is None:
        unwrap.check(obj)
    elif place in (PAINTED, IMAGE):
        editable.require_no_edit_mode(obj)


def _finish(material, choice, gathered, found):
    """Write what was found, and feed the input. Returns a sentence."""
    layer, luts_and_answers = _layer(material, choice), (*found[0].values(), *found[1])
    for error in luts_and_answers:
        if isinstance(error, Exception):
            raise RefusedError(messages.sentence(error, material)) from error
    if _object(choice) is None and choice.place != EVEN:
        raise RefusedError("The object was removed meanwhile")
    if layer.kind not in INPUTS:  # a thin film, which is always even
        return _SAME
    if choice.place != EVEN:
        _check_mesh(_object(choice), layer, choice.place)
    dusting.answered(gathered.tasks, found[1])
    before = thickness.wiring(material, INPUTS[layer.kind]).source
    _keep(material, layer)
    if choice.place == SETTLED and before == "custom":
        thickness.wire_thickness(material, "value", replace=True, to=INPUTS[layer.kind])
    done = dusting.finish(gathered, found)
    if choice.place == SETTLED:
        if layer.kind == "interface":
            object_dust.wire(_object(choice), material, COVERAGE)
        return "; ".join([f"{layer.name} lies on {_object(choice).name}", *done.notes, *_bare(material)])
    put_layer = _put_film if layer.kind == "interface" else _put_medium
    return put_layer(_object(choice), layer, choice.place, before)


def _bare(material):
    """A sentence if other objects with the material show nothing of a layer that settles."""
    bare = [obj.name for obj in bpy.data.objects if obj.type == "MESH" and not obj.lamina_dust.told
            and any(slot.material == material for slot in obj.material_slots)]
    if not bare:
        return []
    more = f" and {len(bare) - 1} more" if len(bare) > 1 else ""
    return [f"{bare[0]}{more} with this material: nothing has settled there yet, see Dust These Objects"]


def _keep(material, layer):
    """Keep in the material what the present place has, for the artist who comes back to this place: the image
    of the layer that varies now, or the thickness of an even medium."""
    name = INPUTS[layer.kind]
    wiring = thickness.wiring(material, name)
    fed = next((one for one in material.lamina.layers if one.varying and INPUTS.get(one.kind) == name), layer)
    if of(material, fed) in (IMAGE, PAINTED) and wiring.source == "image" and wiring.node.image is not None:
        material[_kept_key(fed)] = wiring.node.image
    if of(material, layer) == EVEN and layer.kind == "medium":
        socket = wiring.socket if layer.varying else None
        material[thickness.EVEN] = _range(layer) if socket is None else socket.default_value


def _kept_key(layer):
    """The key of a material for the image of a layer. Blender's keys have up to 63 bytes."""
    return f"{thickness.KEPT[INPUTS[layer.kind]]} {layer.name}".encode()[:63].decode(errors="ignore")


def _kept(layer):
    """The image that the layer had before, or None. Earlier versions kept one image for all layers."""
    keys = _kept_key(layer), thickness.KEPT[INPUTS[layer.kind]]
    return next(filter(None, (layer.id_data.pop(key, None) for key in keys)), None)


def _put_medium(obj, layer, place, before):
    """Feed the thickness of a varying medium, whose source was `before`."""
    material = layer.id_data
    usual = min(_range(layer), material.get(thickness.EVEN, USUAL))
    if place == IMAGE:
        image, told = _kept(layer), "The image that this layer had before"
        if image is None:
            image = thickness.new_image(material, value=usual)
            told = f"The new image holds the thickness {usual:.3g}: paint on it, or choose another one"
        thickness.wire_thickness(material, "image", image, uv_map=_uv_map(obj), replace=True)
        return told
    if thickness.has_input(material):
        socket = thickness.wire_thickness(material, "value", replace=True).socket
        if before in ("attribute", "image", "custom"):
            socket.default_value = usual
    if place == PAINTED:
        wiping.add_mask(obj, material)
        return "Wipe by Hand: white strokes wipe the layer off, black strokes bring it back"
    detail_wiring.remove_mask(material)
    return _SAME


def _put_film(obj, layer, place, before):
    """Feed the coverage of a varying interface, whose source was `before`."""
    material = layer.id_data
    if place != PAINTED:
        if before not in ("none", "value"):
            thickness.wire_thickness(material, "value", replace=True, to=COVERAGE)
        if place == EVEN:
            film_wiring.take(material)
            return _SAME
        film_wiring.put(material, place)
        return "Choose the amount and the size in the panel"
    if of(material, layer) != PAINTED or thickness.wiring(material, COVERAGE).node.image is None:
        uv_map = _uv_map(obj)
        image = _kept(layer) or ""
        thickness.wire_thickness(material, "image", image, uv_map, replace=True, to=COVERAGE)
    return "Paint by Hand: white strokes put the film on, black strokes take it off"


def _uv_map(obj):
    """The name of a UV map of the object, unwrapped if it has none."""
    found = uv_maps.find(obj.data, "")
    return unwrap.ensure(obj) if found is None else found.name


def _object(choice):
    return with_uid(bpy.data.objects, choice.uid)


def _layer(material, choice):
    layers = material.lamina.layers
    if not 0 <= choice.index < len(layers):
        raise RefusedError("The layer was removed meanwhile")
    return layers[choice.index]


def _needs_bake(material, layer, place):
    return (not layer.varying
            or layer.kind == "medium" and place in (SETTLED, IMAGE) and _range(layer) < RANGE
            or bake_job.state(material) not in ("fresh", "other")
            or not thickness.has_input(material, INPUTS[layer.kind]))


def _bake(material, choice):
    """The Bake of the material with the layer that varies. The file is as before."""
    trial = material.copy()
    try:
        _vary(trial, choice)
        return dusting.Bake(stack_io.to_stack(trial), *update.first_settings(trial))
    finally:
        bpy.data.materials.remove(trial)


def _vary(material, choice):
    """Let the layer vary, up to RANGE where values come from elsewhere."""
    layer = _layer(material, choice)
    if layer.kind == "medium":
        layer.infinite = False
        if choice.place in (SETTLED, IMAGE) and _range(layer) < RANGE:
            _raise_range(layer, RANGE)
    layer.varying = True


def _range(layer):
    """The largest optical thickness of a medium, of flakes and their tint, or of fibers along the normal."""
    if layer.kind == "flakes":
        return layer.flake_tau + max(layer.flake_binder)
    if layer.kind == "fibers":
        return layer.fiber_tau * math.sin(layer.fiber_tilt)
    if layer.mode in media.IN_MM:
        absorbed = (0.0,) * 3 if layer.mode == "pigment" else layer.sigma_a  # a pigment's is not known here
        return layer.thickness * max(map(sum, zip(layer.sigma_s, absorbed, strict=True)))
    return max(layer.tau_rgb) if layer.tau_per_channel else layer.tau


def _raise_range(layer, largest):
    before = _range(layer)
    if layer.mode in media.IN_MM:
        if before > 0.0:
            layer.thickness *= largest / before
    elif layer.tau_per_channel and before > 0.0:
        layer.tau_rgb = [value * largest / before for value in layer.tau_rgb]
    else:
        layer.tau, layer.tau_per_channel = largest, False

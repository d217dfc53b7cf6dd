# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes lateral light transport: in a blocking function, or in a worker thread that is polled."""

import logging

import bpy

from ..base import native
from ..base.worker import OfMaterial, Place, Worker, with_uid
from ..editing import layer_list, stack_io
from ..nodes import before, lateral_group, portal_graph, relightable_graph, volume_graph
from ..properties.material_properties import AUTOMATIC
from . import body_thickness, lateral_body, volume_bounces

log = logging.getLogger(__name__)

_place = Place()
running, forget, stop, take = _place.running, _place.forget, _place.stop, _place.take
running_for, register, unregister = _place.running_for, _place.register, _place.unregister


class LateralJob(OfMaterial, Worker):
    """The computation for one material."""

    def __init__(self, material, scene):
        self.uid, self.scene_uid, self.millimetre = material.session_uid, scene.session_uid, millimetre(scene)
        self.output, quality = material.lamina.lateral, material.lamina.quality
        self.layers = made_from(material)
        self.note = lateral_body.require(bpy.context, scene, material, self.output)
        stack, compute = stack_io.to_stack(material), computation(self.output, material)
        super().__init__(lambda progress, cancel: compute(stack, quality, progress, cancel), "lamina lateral")

    def apply(self, material):
        """Build the node group. A scene that was deleted meanwhile needs no bounces."""
        scene = with_uid(bpy.data.scenes, self.scene_uid)
        show(material, scene, self.output, self.layers, self.note, self.result, self.millimetre)


def make(material, scene=None, quality=None, output=None):
    """Compute the material's light that travels sideways and build its node group. Blocks.

    `output` is "RELIGHTABLE", "PORTAL" or "VOLUME", by default the material's choice. Returns the computed
    lamina.SubsurfaceInputs, lamina.PortalTables or volume_graph.Body. `scene` gives the length of a Blender
    unit and gets the bounces that a volume needs; the default is the context's scene. Raises
    lamina.StackError for media without lengths, RefusedError and lamina.InteriorError for objects of the
    scene that do not fit, SolveError and NativeMissingError; the material is then unchanged."""
    output, layers = output or material.lamina.lateral, made_from(material)
    scene = scene or bpy.context.scene
    note = lateral_body.require(bpy.context, scene, material, output)
    found = computation(output, material)(stack_io.to_stack(material), quality or material.lamina.quality)
    show(material, scene, output, layers, note, found, millimetre(scene))
    return found


def start(material, scene):
    """Start a background job; only one runs at a time. Raises like make, before the job starts."""
    return take(LateralJob(material, scene))


def millimetre(scene):
    """Blender units per millimetre: a unit is scene.unit_settings.scale_length metres."""
    return 0.001 / scene.unit_settings.scale_length


def computation(output, material):
    """The function of (stack, quality, progress, cancel) that computes this output of the material."""
    lamina, release = native.require(), tuple(bpy.app.version[:2])
    scatterings = material.lamina.lateral_orders or None

    def compute(stack, quality, progress=None, cancel=None):
        if output == "PORTAL":
            return lamina.portal_tables(stack, quality, progress, cancel, scatterings)
        if output == "VOLUME":
            interior, surface = native.part("interior.of_stack").interior_of_stack(stack)
            return volume_graph.Body(interior.palette[0], surface)
        return lamina.subsurface_nodes(stack, release, quality=quality, progress=progress, cancel=cancel)

    return compute


def made_from(material):
    """What a result depends on, as text: the mark of the layers, and the number of scatterings."""
    return f"{layer_list.mark(material)} {material.lamina.lateral_orders}"


def stale(material):
    """The reason why the last result does not fit the layers or the choice, in a sentence, or ''."""
    settings = material.lamina
    if not settings.lateral_report or not settings.lateral_layers:  # none, or one of an earlier version
        return ""
    layers, *orders = settings.lateral_layers.split()  # of an earlier version: the layers alone
    if layers != layer_list.mark(material):
        return "Out of date: the layers have changed"
    if settings.lateral not in (settings.lateral_shown, AUTOMATIC):
        names = {item.identifier: item.name for item in settings.bl_rna.properties["lateral"].enum_items}
        shown, chosen = names.get(settings.lateral_shown, ""), names[settings.lateral]
        return f"Out of date: computed with output {shown} instead of {chosen}"
    if settings.lateral_shown == "PORTAL" and orders not in ([], [str(settings.lateral_orders)]):
        return "Out of date: computed with another number of scatterings"
    return ""


def show(material, scene, output, layers, note, found, length):
    """Build the nodes of what `computation` has found. `layers`: of made_from; `note`: a sentence about the
    objects, or ''. `scene`: gets the bounces that a volume needs, None: no scene. `length`: of a
    millimetre."""

    def draw(graph, socket, _more):
        unit = graph.value(socket)
        if output == "PORTAL":
            return portal_graph.draw(graph, found, unit, f"Lamina Portal {material.name}")
        draw_other = volume_graph.draw if output == "VOLUME" else relightable_graph.draw
        return draw_other(graph, found, unit)

    lateral_group.build(material, output.capitalize(), draw, length)
    body_thickness.note(material.lamina.lateral_group, output, found)
    if output == "PORTAL":
        before.switch_correction_off(material)
        if found.first is not None:
            material.lamina.lateral_scatterings = found.first.count
    elif output == "VOLUME":
        material.lamina.lateral_scatterings = found.bounces
    before.restore_sampling(material)
    # An interior, whose nodes these replace, is no longer on show.
    interior = material.lamina.interior
    interior.report = interior.made_from = ""
    material.lamina.lateral_shown, material.lamina.lateral_layers = output, layers
    raised = "" if scene is None else volume_bounces.provide(scene, material)
    sentences = [found.report, note, raised and f"{raised}."]
    material.lamina.lateral_report = " ".join(filter(None, sentences))

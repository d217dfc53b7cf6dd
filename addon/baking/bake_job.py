# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes: by a blocking function, or in a worker thread that the main thread polls.

The worker gets a stack and numbers, never Blender data. The running job and the last failure of each material
are kept here for the session, and not in the .blend.
"""

import json
import logging

from bpy.app.handlers import persistent

from ..base import changes, handlers, messages, native, preferences
from ..base.worker import OfMaterial, Place, Worker
from ..editing import stack_io
from ..nodes import detail_wiring, displacement, film_wiring, node_group, tangent, thickness
from ..stack_json import stack_check

log = logging.getLogger(__name__)

COARSE = "coarse"  # quality of an update with fewer rows or nodes

_place = Place()
running, running_for, forget, stop = _place.running, _place.running_for, _place.forget, _place.stop
_failures = {}


class Job(Worker):
    """One bake in a worker thread. `stack`: a stack, or a function that the thread calls for one.
    `more`: further arguments of lamina.bake. `drawn`: also make the curves of the result's picture.
    At the end, `stack` is the baked one, and `curves` is the text for apply()."""

    def __init__(self, stack, quality, threads, drawn=True, **more):
        bake = native.require().bake
        self.stack, self.curves = None, None

        def work(progress, cancel):
            self.stack = stack() if callable(stack) else stack
            lut = bake(self.stack, quality=quality, progress=progress, cancel=cancel, threads=threads, **more)
            self.curves = curves_of(self.stack, lut, threads) if drawn else None
            return lut

        super().__init__(work, "lamina bake")

    @property
    def lut(self):
        return self.result


class MaterialJob(OfMaterial, Job):
    """A bake for one material."""

    def __init__(self, material, quality, threads, stack=None, **more):
        self.uid, self.quality = material.session_uid, quality
        more["basis"] = preferences.table_basis(more.get("basis") or material.lamina.basis)
        super().__init__(stack or stack_io.to_stack(material), quality, threads, **more)

    def apply(self, material):
        apply(material, self.lut, self.curves)


def bake_material(material, quality=None, threads=None, progress=None, cancel=None, basis=None):
    """Bake the material's stack and build its node group; returns the LUT. Blocks.

    `progress(fraction, text)` and `cancel() -> bool` as in lamina.bake. On any error the material
    keeps its earlier bake. Raises lamina.StackError, SolveError, Cancelled, NativeMissingError,
    UnknownClosureError.
    """
    lamina = native.require()
    stack = stack_io.to_stack(material)
    threads = preferences.threads() if threads is None else threads
    lut = lamina.bake(
        stack,
        quality=quality or material.lamina.quality,
        progress=progress,
        cancel=cancel,
        threads=threads,
        basis=preferences.table_basis(basis or material.lamina.basis),
    )
    apply(material, lut, curves_of(stack, lut, threads))
    return lut


def curves_of(stack, lut, threads=0):
    """The curves of the result's picture as JSON, or "" if they cannot be computed."""
    try:
        return json.dumps(native.part("baking.report.result_curves").result_curves(stack, lut, threads))
    except native.require().SolveError as error:  # the bake itself is complete
        log.warning("no picture of the result: %s", error)
        return ""


def apply(material, lut, curves=None, in_place=False, coarse=False):
    """Build the material's node group from a finished LUT and note its report.

    `curves`: of the result's picture, see curves_of; None keeps the last picture. With `in_place`, a group of
    the same layout gets a new image only. `coarse`: the LUT has fewer rows or nodes, and its quality is
    stored as COARSE.
    """
    if not (in_place and node_group.update(material, lut)):
        missing = [name for name in thickness.INPUTS if not thickness.has_input(material, name)]
        node_group.build(material, lut)
        for name in missing:
            thickness.reconnect(material, name)
    if not thickness.has_input(material):
        displacement.remove(material)
    detail_wiring.add_if_wanted(material)
    film_wiring.follow(material)
    tangent.follow(material)
    material.lamina.result.note(lut)
    if curves is not None:
        material.lamina.result.curves = curves
    if coarse:
        material.lamina.result.quality = COARSE
    clear_failure(material)


def start(material, quality=None, basis=None):
    """Start a bake in the background, by default with the material's quality and basis; one at a time. Raises
    like bake_material, before it starts."""
    quality, basis = quality or material.lamina.quality, basis or material.lamina.basis
    return _place.take(MaterialJob(material, quality, preferences.threads(), basis=basis))


def note_failure(material, error):
    """Keep the sentence for the panel, until the stack changes or a bake succeeds. Returns it."""
    if not messages.expected(error):
        log.error("bake of %s failed", material.name, exc_info=error)
    text = messages.sentence(error, material)
    _failures[material.session_uid] = (repr(stack_io.to_dict(material)), text)
    return text


def failure(material):
    """Why the last bake of the material's present stack failed, or ''."""
    stack, text = _failures.get(material.session_uid, ("", ""))
    return text if text and stack == repr(stack_io.to_dict(material)) else ""


def clear_failure(material):
    _failures.pop(material.session_uid, None)


def state(material, quality=None, basis=None):
    """The state of the material's bake relative to its layers and to a quality and basis, by default the
    chosen ones:

    'none' before the first bake, and without its nodes or a table; 'invalid', the layers cannot be baked;
    'stale', the layers have changed since; 'fresh', a bake of these layers at that quality and basis;
    'other', a bake of these layers at another quality or basis, see `difference`; 'older', a bake by a
    version of Lamina whose results for these layers have changed since, see `version_difference`.
    """
    result, group = material.lamina.result, material.lamina.node_group
    if not result.stack_hash or group is None or not node_group.has_tables(group):
        return "none"
    stack, error = stack_check.of(stack_io.to_text(material))
    if error is not None:
        return "invalid"
    if stack.hash != result.stack_hash:
        return "stale"
    if difference(material, quality, basis):
        return "other"
    return "older" if version_difference(material) else "fresh"


def difference(material, quality=None, basis=None):
    """Which settings the last bake was made with and which are wanted, by default the chosen ones, as
    'quality Preview instead of Final', or '' when they are the same."""
    settings, result = material.lamina, material.lamina.result
    wanted_quality = quality or settings.quality
    wanted_fit = preferences.fit_of(basis or settings.basis)
    baked_fit = preferences.fit_of(result.basis)
    pairs = (("quality", result.quality, wanted_quality), ("fit", baked_fit, wanted_fit))
    return ", ".join(
        f"{name} {baked.capitalize()} instead of {wanted.capitalize()}"
        for name, baked, wanted in pairs
        if baked and baked != wanted
    )


def version_difference(material):
    """Which version made the last bake, and which later ones changed the results for such layers, or ''.
    Raises lamina.StackError, NativeMissingError."""
    told = native.part("baking.report.result_changes").told
    return told(material.lamina.result.version, stack_io.to_stack(material))


@persistent
def _on_load(*_):
    stop()
    _failures.clear()


HANDLERS = {"load_pre": _on_load}


def register():
    changes.removals.append(clear_failure)
    changes.turns.append(tangent.follow)
    handlers.add(HANDLERS)


def unregister():
    stop()
    _failures.clear()
    changes.removals.remove(clear_failure)
    changes.turns.remove(tangent.follow)
    handlers.remove(HANDLERS)

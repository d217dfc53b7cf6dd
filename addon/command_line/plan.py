# SPDX-License-Identifier: GPL-3.0-or-later
"""What a batch is to do with one material of the open file."""

from ..baking import bake_job
from ..base import editable, messages, native, preferences
from ..editing import over_material, stack_io
from ..properties import migration
from . import words
from .finished_tables import Wanted

TEXEL = 16  # bytes of four float32 channels
NODES = 500_000  # bytes that the nodes of a group take at most in a .blend


class Plan:
    """One material, with the layers that the arguments give it.

    `wanted`: the table that the material needs, or None after an `error`. `is_fresh`: the material shows this
    table already. `has_changed`: the material is not as it was."""

    def __init__(self, material, stack, arguments):
        self.material, self.name = material, material.name
        self.quality = arguments.quality or material.lamina.quality
        self.basis = preferences.table_basis(arguments.basis or material.lamina.basis)
        self.wanted, self.error, self.reason = None, None, ""
        self.is_fresh = self.has_changed = False
        self.lost = []
        self._was_enabled = material.lamina.enabled
        self._before = None
        self._is_given = stack is not None or arguments.over
        try:
            self._make(stack, arguments)
        except Exception as error:  # the other materials go on
            self.fail(error)
        except BaseException:
            self.undo()
            raise

    def _make(self, stack, arguments):
        material = self.material
        problem = migration.problem(material)
        if problem:
            raise messages.RefusedError(problem)
        if self._was_enabled:
            self._before = stack_io.to_dict(material)
        if arguments.over and not self._was_enabled:
            self.lost = over_material.not_carried(material)
        self._give(stack, arguments.over)
        if not material.lamina.enabled:
            raise messages.RefusedError("has no Lamina layers (give --stack JSON)")
        # New layers come with settings of their own.
        self.quality = arguments.quality or material.lamina.quality
        self.basis = preferences.table_basis(arguments.basis or material.lamina.basis)
        self.has_changed = not self._was_enabled or stack_io.to_dict(material) != self._before
        self.wanted = Wanted(stack_io.to_stack(material), self.quality, self.basis)
        if words.state_of(material, self.quality, self.basis) != "fresh":
            self.reason = words.state(material, self.quality, self.basis)
        elif arguments.force:
            self.reason = "baked again by --force"
        else:
            self.is_fresh = True

    def _give(self, stack, over):
        if over and not over_material.is_over(self.material):
            over_material.add(self.material)
        if stack is not None:
            assign = over_material.assign_layers if over else stack_io.assign_stack
            assign(self.material, stack)

    @property
    def growth(self):
        """The bytes by which a save of the file can grow at most because of this material."""
        if self.wanted is None or self.is_fresh:
            return 0
        height, width = native.part("baking.bases.choice").largest_size(self.wanted.stack, self.basis)
        return (1 << (height - 1).bit_length()) * width * TEXEL + NODES

    def apply(self, lut):
        """Build the material's node group."""
        bake_job.apply(self.material, lut)
        self.has_changed = True

    def fail(self, error):
        """Note an error; the material keeps the layers of its earlier bake."""
        self.undo()
        self.error, self.reason = error, messages.sentence(error, self.material)

    def undo(self):
        """Take back the layers that the arguments gave."""
        self.has_changed = False
        if not self._is_given:
            return
        if self._before is not None:
            stack_io.assign(self.material, self._before)
        elif not self._was_enabled and editable.is_editable(self.material):
            self.material.property_unset("lamina")

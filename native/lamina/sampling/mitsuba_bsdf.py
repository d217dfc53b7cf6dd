# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks as a BSDF plugin of Mitsuba 3, in any of its variants without polarisation."""

from __future__ import annotations

import json
from typing import Any

from ..common.arguments import check_number
from ..common.errors import ArgumentError, StackError, quoted
from ..common.extras import require
from ..material.any_stack import as_stack
from ..material.stack import Stack
from ..solver.solve import solve
from .mitsuba_reader import Reader
from .render_table import RenderTable

NAME = "lamina"


def register() -> None:
    """Makes "lamina" a BSDF plugin of Mitsuba's present variant: call it after each `mitsuba.set_variant`. Its
    parameter `stack` is the id of a preset, the JSON of a stack, or the path of a JSON file or of a table that
    RenderTable.save wrote; `quality` is "final" or "preview"; `tau` as in `bsdf`. Stacks with wavelengths have their
    colors under D65 in variants of RGB. Raises ExtraMissing without mitsuba, and ArgumentError."""
    mi = require("mitsuba", "the plugin for Mitsuba")
    plugin = _plugin(mi)
    mi.register_bsdf(NAME, plugin)


def bsdf(table: RenderTable, tau: Any = None) -> Any:
    """The BSDF of a table for Mitsuba's present variant, to be used in the dictionary of a scene. `tau`: the thickness
    of a varying layer in its thickest channel, a number of at least 0 or a texture of Mitsuba with raw values; by
    default the largest, which larger ones count as. Raises ExtraMissing without mitsuba, and ArgumentError."""
    mi = require("mitsuba", "the plugin for Mitsuba")
    if not isinstance(table, RenderTable):
        raise ArgumentError(f"table = {quoted(table)}: must be a lamina.mitsuba.RenderTable")
    if tau is not None and table.rows == 1:
        raise ArgumentError("tau: the table has no varying layer")
    plugin, props = _plugin(mi), mi.Properties(NAME)
    if tau is not None:
        rule = "must be a number of at least 0, or a texture of Mitsuba"
        props["tau"] = tau if isinstance(tau, mi.Texture) else check_number(tau, "tau", rule, lambda one: one >= 0.0)
    return plugin(props, table)


def _table(given: str, quality: str) -> RenderTable:
    """The table of a stack as the plugin's parameters name it. Raises what solving and loading raise."""
    if given.endswith(".npz"):
        return RenderTable.load(given)
    if given.lstrip().startswith("{"):
        try:
            stack = Stack.from_json(json.loads(given))
        except ValueError as error:
            raise StackError(f"stack: not the JSON of a stack: {error}") from None
    else:
        stack = as_stack(given)
    return RenderTable.of(solve(stack, quality), quality)


def _plugin(mi: Any) -> type:
    """The class of the plugin for the present variant."""
    if mi.variant() is None or "polarized" in mi.variant():
        raise ArgumentError(f"variant = {mi.variant()}: call mitsuba.set_variant with one without polarisation before")
    import drjit as dr

    class LaminaBSDF(mi.BSDF):
        """Reflection, transmission and specular light of a stack, the same from both sides for a sheet."""

        def __init__(self, props: Any, table: RenderTable | None = None):
            mi.BSDF.__init__(self, props)
            if table is None:
                table = _table(str(props["stack"]), str(props.get("quality", "final")))
            self._table = table
            self._read = Reader(table, mi, dr)
            self._tau = props.get_texture("tau", table.largest) if table.rows > 1 else None
            sheet = len(table.sights) > 1
            sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide if sheet else mi.BSDFFlags.FrontSide
            flags = [[mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.DeltaReflection],
                     [mi.BSDFFlags.GlossyTransmission, mi.BSDFFlags.Null]]
            # (path, 1 if specular, the flag) of each component.
            self._parts = []
            for path in range(2 if sheet else 1):
                for specular in (0, 1):
                    if not specular or table.mirrored[path::2].any():
                        self._parts.append((path, specular, flags[path][specular]))
            self.m_components = [flag | sides for _, _, flag in self._parts]
            self.m_flags = self.m_components[0]
            for more in self.m_components[1:]:
                self.m_flags |= more

        def sample(self, ctx, si, sample1, sample2, active=True):
            bs = mi.BSDFSample3f()
            active, row = active & self._seen(si.wi), self._row(si, active)
            chances = self._chances(ctx, si.wi, row)
            light, pdf, drawn = mi.Vector3f(0.0), mi.Float(0.0), mi.Bool(False)
            weight = mi.Spectrum(0.0)
            start = mi.Float(0.0)
            numbers = mi.UInt32(0)
            types = mi.UInt32(0)
            mirror = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
            for number, ((path, specular, flag), chance) in enumerate(zip(self._parts, chances, strict=True)):
                here = (sample1 >= start) & (sample1 < start + chance) & active
                start = start + chance
                if specular:
                    found = mirror if path == 0 else -si.wi
                    own = self._read.specular(path, si.wi, row, si.wavelengths, here)
                    own *= dr.rcp(dr.maximum(chance, 1e-12))
                    good, density = here, chance
                else:
                    found, good = self._read.drawn(path, si.wi, row, sample2, here)
                    good = good & here
                    density = self._density(chances, si.wi, found, row, good)
                    own = (self._read.values(si.wi, found, row, si.wavelengths, good) * dr.abs(found.z)
                           * dr.rcp(dr.maximum(density, 1e-30)))
                    good = good & (density > 0.0)
                light = dr.select(good, found, light)
                pdf = dr.select(good, density, pdf)
                weight = dr.select(good, own, weight)
                numbers = dr.select(good, mi.UInt32(number), numbers)
                types = dr.select(good, mi.UInt32(int(flag)), types)
                drawn = drawn | good
            bs.wo, bs.pdf, bs.eta = light, dr.select(drawn, pdf, 0.0), 1.0
            bs.sampled_component, bs.sampled_type = numbers, types
            return bs, dr.select(drawn, weight, mi.Spectrum(0.0))

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            active, row = active & self._seen(si.wi), self._row(si, active)
            return self._density(self._chances(ctx, si.wi, row), si.wi, wo, row, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            active, row = active & self._seen(si.wi), self._row(si, active)
            seen = mi.Bool(False)
            for number, (path, specular, flag) in enumerate(self._parts):
                if not specular and ctx.is_enabled(flag, number):
                    seen = seen | ((si.wi.z * wo.z > 0.0) if path == 0 else (si.wi.z * wo.z < 0.0))
            active = active & seen
            value = self._read.values(si.wi, wo, row, si.wavelengths, active) * dr.abs(wo.z)
            density = self._density(self._chances(ctx, si.wi, row), si.wi, wo, row, active)
            return dr.select(active, value, mi.Spectrum(0.0)), density

        def _seen(self, wi):
            return (wi.z != 0.0) if len(self._table.sights) > 1 else (wi.z > 0.0)

        def _row(self, si, active):
            return None if self._tau is None else self._read.row(self._tau.eval_1(si, active))

        def _chances(self, ctx, wi, row):
            """By component the chance to draw it, 0 for those that are not asked for."""
            found = [self._read.chance(path, specular, wi, row) if ctx.is_enabled(flag, number) else mi.Float(0.0)
                     for number, (path, specular, flag) in enumerate(self._parts)]
            total = sum(found, mi.Float(0.0))
            return [one * dr.rcp(dr.maximum(total, 1e-12)) for one in found]

        def _density(self, chances, wi, wo, row, active):
            """Probability per solid angle of a direction that is not specular."""
            total = mi.Float(0.0)
            for (path, specular, _), chance in zip(self._parts, chances, strict=True):
                if not specular:
                    here = active & ((wi.z * wo.z > 0.0) if path == 0 else (wi.z * wo.z < 0.0))
                    total = total + dr.select(here, chance * self._read.density(path, wi, wo, row, here), 0.0)
            return total

        def traverse(self, callback):
            if self._tau is not None:
                callback.put("tau", self._tau, mi.ParamFlags.Differentiable)

        def to_string(self):
            return f"Lamina[{self._table.name}, channels = {self._table.channels}]"

    return LaminaBSDF

# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D scattering function of a plane stack: light of a pencil beam by the distance at which it leaves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import _core
from ..common.arguments import LEAST_BEAM_COSINE, check_number, finite_array
from ..common.errors import ArgumentError
from ..common.interruptible import interruptible
from ..common.progress import Progress, portion, stepper
from ..material.any_stack import AnyStack, as_stack
from ..material.stack import Stack
from ..solver.core_calls import or_solve_error, thread_pool, tolerance_of
from .measured import measured_layers, measured_stack


def searchlight(stack: AnyStack, mu_i: float = 1.0, quality: str = "final", threads: int = 0,
                progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> Searchlight:
    """The response of a stack to a pencil beam on its top at the cosine `mu_i`, in (0, 1]; less than 1e-4 counts as
    1e-4. Deterministic.

    Every medium needs lengths: `sigma_s` and `sigma_a` (1/mm) and `thickness` (mm); a half-space needs the first two.
    `quality` "final" has errors of about 1e-6 of the incident flux at a frequency and .1 % in a profile, "preview" of
    1e-4 and 3 %. Under layers that are clear, or thick but hardly scatter, the errors are 3e-3 of the flux, and 1 % of
    the mean distance. At frequencies above 1 over the thickness, layers that are thinner than a mean free path, oblique
    beams and rough boundaries have errors of 3e-4 of the flux, and of 1e-3 for strong forward scattering.
    `threads` 0 uses every hardware thread; results do not depend on it. `progress(fraction, text)` is called with the
    completed share, 0 to 1. `cancel()` is called often; Cancelled is raised if it returns true.

    Raises StackError for a medium without lengths, SolveError, with the numbers, if the finest resolution misses the
    tolerance, and ArgumentError, a ValueError, for arguments out of range.
    Method: discrete ordinates at lateral frequencies, which couple azimuths; layers by doubling, joined by the adding
    equations; a Hankel transform after subtraction of single scattering. See docs/theory.md."""
    stack = as_stack(stack)
    stack.require_isotropic("a searchlight")
    stack.require_no_flakes("a searchlight")
    tolerance_of(quality)
    mu_i = check_number(mu_i, "mu_i", "must lie in (0, 1]", lambda mu: 0.0 < mu <= 1.0)
    mu_i = max(mu_i, LEAST_BEAM_COSINE)
    step = stepper("the searchlight", progress, cancel)
    pool = thread_pool(threads)
    solved: dict = {}
    channels = [measured_layers(stack, index, quality) for index in range(stack.channels)]
    distinct = list(dict.fromkeys(channels))
    for number, (layers, base) in enumerate(distinct):
        part = portion(step, number / len(distinct), (number + 1) / len(distinct))
        core = _core.Searchlight(measured_stack(layers, base), mu_i, quality == "preview")
        while not core.done:
            _advance(core, pool, part)
        solved[layers, base] = core
    step(1.0, "Done")
    return Searchlight(stack, mu_i, [solved[key] for key in channels], pool, (stack, mu_i, quality, threads))


def _advance(core: _core.Searchlight, pool: _core.ThreadPool, step: Progress) -> None:
    """One part of the core's work. Raises SolveError, and what `step` raises."""
    done = core.progress

    def ask() -> None:
        step(done, "Light that travels sideways")

    ask()
    or_solve_error(lambda: interruptible(pool, lambda: core.advance(pool), ask))


class Searchlight:
    """The response to a pencil beam of unit flux at r = 0. Lengths are in millimetres.

    Fluxes and mean distances have the shape (channels,). Functions of distance or frequency return the shape of their
    argument, with a last axis of channels if there are several. For an oblique beam all values are means over azimuths
    about the point of entry. A pickled response is solved again when it is loaded, with the same result."""

    def __init__(self, stack: Stack, mu_i: float, channels: list, pool, made: tuple):
        self.stack = stack
        self.mu_i = mu_i
        self._channels = channels
        self._pool = pool
        self._made = made  # the arguments of searchlight

    def __reduce__(self):
        return searchlight, self._made

    def __repr__(self) -> str:
        return (f"<Searchlight of {self.stack.label}: mu_i {self.mu_i:g}, {len(self._channels)} channels, reflectance "
                f"{' '.join(f'{value:.4f}' for value in self.reflectance)}>")

    @property
    def reflectance(self) -> np.ndarray:
        """Total reflected flux."""
        return self._each(lambda light: light.flux)

    @property
    def transmittance(self) -> np.ndarray:
        """Total transmitted flux, unscattered light included; 0 over a base."""
        return self._each(lambda light: light.flux, "transmitted")

    @property
    def mirrored(self) -> np.ndarray:
        """Reflected flux that neither media nor facets have scattered: specular reflection by smooth boundaries and
        metals."""
        return self._each(lambda light: light.direct)

    @property
    def unscattered(self) -> np.ndarray:
        """Transmitted flux that no medium has scattered and that leaves where the beam leaves."""
        return self._each(lambda light: light.direct, "transmitted")

    @property
    def mean_distance(self) -> np.ndarray:
        """Mean distance of reflected light from the point of entry, mm. Specular reflection counts with its distance, 0
        along the normal. Infinite if a half-space absorbs nothing; NaN if nothing is reflected."""
        return self._each(lambda light: light.distance / light.flux if light.flux > 0.0 else np.nan)

    @property
    def mean_square_distance(self) -> np.ndarray:
        """Mean square of this distance, mm^2."""
        return self._each(lambda light: light.square_distance / light.flux if light.flux > 0.0 else np.nan)

    def reflected_inside(self, r) -> np.ndarray:
        """Flux reflected within the distance `r`, mm, from the point of entry. Raises ArgumentError."""
        return self._at("r", r, lambda light, places: light.inside(places, self._pool))

    def transmitted_inside(self, r) -> np.ndarray:
        """Flux transmitted within the distance `r`, mm, from the point below the point of entry. Raises
        ArgumentError."""
        return self._at("r", r, lambda light, places: light.inside(places, self._pool), "transmitted")

    def reflected_at(self, q) -> np.ndarray:
        """Integral of the reflected flux density times J0(q r), `q` in 1/mm. Raises ArgumentError."""
        return self._at("q", q, lambda light, places: light.at(places, self._pool))

    def transmitted_at(self, q) -> np.ndarray:
        """The same for the transmitted flux density."""
        return self._at("q", q, lambda light, places: light.at(places, self._pool), "transmitted")

    def profile(self, r) -> np.ndarray:
        """Flux density of reflected light at the distance `r` > 0, 1/mm^2, without specular reflection and unscattered
        light. Raises ArgumentError."""
        return self._at("r", r, lambda light, places: light.density(places, self._pool), least=0.0)

    def transmitted_profile(self, r) -> np.ndarray:
        """The same for transmitted light."""
        return self._at("r", r, lambda light, places: light.density(places, self._pool), "transmitted", least=0.0)

    @property
    def nodes(self) -> int:
        """Number of nodes per hemisphere, chosen by the solver."""
        return max(core.nodes for core in self._channels)

    @property
    def frequencies(self) -> int:
        """Number of lateral frequencies between which the solver interpolates."""
        return max(core.frequencies for core in self._channels)

    def _each(self, value, face: str = "reflected") -> np.ndarray:
        return np.array([value(getattr(core, face)) for core in self._channels])

    def _at(self, name: str, values, call, face: str = "reflected", least: float | None = None) -> np.ndarray:
        places = finite_array(values, name)
        wrong = places < 0.0 if least is None else places <= least
        if np.any(wrong):
            rule = "must be at least 0" if least is None else "must be larger than 0"
            raise ArgumentError(f"{name} = {places[wrong].flat[0]:g}: {rule}")
        flat = np.ascontiguousarray(places, dtype=float).ravel()
        done: dict = {}
        for core in self._channels:
            if id(core) not in done:
                done[id(core)] = call(getattr(core, face), flat).reshape(places.shape)
        columns = [done[id(core)] for core in self._channels]
        return columns[0] if len(columns) == 1 else np.stack(columns, axis=-1)

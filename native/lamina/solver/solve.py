# SPDX-License-Identifier: GPL-3.0-or-later
"""The deterministic solver: a stack's scattering function by adding solved layers."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..common.arguments import broadcast, check_flag, check_number, check_whole, cosines, finite_array, finite_list
from ..common.errors import ArgumentError, StackError, quoted
from ..common.interruptible import interruptible
from ..common.progress import Progress, portion, stepper
from ..kinds.bases import Lambert, Measured, PrincipledBase, Retroreflector
from ..kinds.fields import channel
from ..kinds.flakes import AMOUNT
from ..kinds.layers import OrientedLayer
from ..kinds.media import TAU
from ..material.any_stack import AnyStack, as_stack
from ..material.layers import Medium
from ..material.profile import THICKNESS
from ..material.stack import Stack
from ..material.thickness import check_opaque, with_thickness
from . import labelled, sharp_facets
from .core_calls import check_nodes, or_solve_error, path_of, side_of, thread_pool, tolerance_of
from .core_stack import core_stack

FACETS_SHARE = 0.2  # of the time, for the energy of narrow facets where mirrors replace them


def solve(stack: AnyStack, quality: str = "final", threads: int = 0, nodes: int | None = None,
          progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> ScatteringFunction:
    """The scattering function of a stack, which is a lamina.Stack, the id of a preset, or the path of a JSON file.

    The relative pointwise tolerance (cosines >= .05) is .1 % ("final") or 1 % ("preview"). `threads` 0 uses every
    hardware thread; results do not depend on it. In stacks with boundaries, the tolerance is relative to at least 1e-3
    per steradian and to at least 1e-3 of the mean over azimuths. At most 200 azimuth orders are tried. `nodes` sets the
    number of nodes per hemisphere, without a check of the tolerance, for previews; the azimuth orders are the first
    number that a solve would try. `progress(fraction, text)` is called with the share of the channels that are solved,
    0 to 1. `cancel()` is called often; Cancelled is raised if it returns true.

    Raises SolveError, with the numbers, when the finest resolution misses the tolerance, and ArgumentError, a
    ValueError, for arguments out of range: `threads` 0 to 1024, `nodes` 8 to 160.
    Method: discrete ordinates per azimuth order, solved by modes (Nakajima and Tanaka 1986), layers joined
    by the adding equations (van de Hulst 1963), truncation of the forward peak with exact single
    scattering (Nakajima and Tanaka 1988).
    A PrincipledBase of roughness below .173 is solved as a mirror that has the energy of the facets.

    Stacks with anisotropic facets are solved with coupled azimuths, on nodes and Fourier functions of the azimuth.
    Their facets have widths of at least .03. Light beyond the first facets then has errors of .3 % ("final"), and all
    values depend on azimuths from the tangent: see ScatteringFunction."""
    stack = as_stack(stack)
    if stack.is_oriented:
        stack.require_no_flakes("a solve with anisotropic facets")
    if stack.is_oriented and isinstance(stack.base, PrincipledBase | Measured | Retroreflector):
        raise StackError(f"base.kind = '{stack.base.kind}': must be another kind below anisotropic facets")
    if stack.is_oriented and nodes is not None:
        raise ArgumentError(f"nodes = {quoted(nodes)}: must be left out for a stack with anisotropic facets")
    step = None if progress is None and cancel is None else stepper("the solve", progress, cancel)
    return _solved(stack, stack, quality, threads, nodes, solve, step)


def solve_with_mirrors(stack: Stack, quality: str = "final", threads: int = 0,
                       nodes: int | None = None) -> ScatteringFunction:
    """Like solve, with mirrors in place of all facets narrower than alpha .03. On an opaque base, the mirrors have the
    energy of the facets."""
    return _solved(sharp_facets.as_mirrors(stack), stack, quality, threads, nodes, solve_with_mirrors)


def _solved(shown: Stack, stack: Stack, quality: str, threads: int, nodes: int | None, made: Callable,
            step: Progress | None = None):
    """The scattering function of `shown`, in which mirrors replace sharp facets of `stack`."""
    method = _Method(tolerance_of(quality), check_nodes(nodes), thread_pool(threads), step=step)
    again = (made, (stack, quality, threads, nodes))
    facets = None
    if sharp_facets.has_sharp_facets(stack, shown):
        mean = replace(method, only_mean=True, step=None if step is None else portion(step, 0.0, FACETS_SHARE))
        method = replace(method, step=None if step is None else portion(step, FACETS_SHARE, 1.0))
        facets = ScatteringFunction(stack, mean.channels(stack), replace(mean, step=None), again)
    channels = method.channels(shown)
    if step is not None:
        step(1.0, "Solved")
    return ScatteringFunction(shown, channels, replace(method, step=None), again, facets)


@dataclass(frozen=True)
class _Method:
    """How the channels of a stack are solved. `only_mean`: the mean over azimuths alone, which gives fluxes, for facets
    of any width."""

    tolerance: float
    nodes: int | None
    pool: _core.ThreadPool
    only_mean: bool = False
    step: Progress | None = None

    def channels(self, stack: Stack) -> list[_core.Solution]:
        """The solution of each channel; channels with equal parts share one."""
        solved: dict = {}
        channels = []
        for index in range(stack.channels):
            key, layers, base = core_stack(stack, index, self.only_mean)
            if key not in solved:
                solved[key] = self._solve(_core.Stack(layers, base), index / stack.channels, stack.is_oriented)
            channels.append(solved[key])
        return channels

    def channel(self, stack: Stack, index: int) -> _core.Solution:
        return self._solve(_core.Stack(*core_stack(stack, index, self.only_mean)[1:]), 0.0)

    def _solve(self, core: _core.Stack, done: float, oriented: bool = False) -> _core.Solution:
        """`done`: the share of the work before this channel."""
        step = self.step
        ask = None if step is None else lambda: step(done, "Solving")
        return or_solve_error(lambda: interruptible(self.pool, lambda: self._solution(core, oriented), ask))

    def _solution(self, core: _core.Stack, oriented: bool):
        if oriented:
            return _core.solve_oriented(core, self.tolerance, self.pool)
        if self.only_mean:
            return _core.solve_mean(core, self.tolerance, self.pool)
        if self.nodes is not None:
            return _core.solve_roughly(core, self.tolerance, self.nodes, self.pool)
        return _core.solve(core, self.tolerance, self.pool)


class ScatteringFunction:
    """A solved stack. Cosines lie in (0, 1] and belong to directions in air, above and below the stack. The last axis
    of every result is that of channels. Cosines below 1e-9 count as 1e-9, where BRDFs have their limit at grazing.

    A sheet may end in a medium other than air (its last Interface has an ior other than 1). Then `brdf`, `reflectance`
    and `transmittance` are defined for light from the top, whose directions are in air; the transmittance is the flux
    into the medium below. `btdf` and everything with side "bottom" need a direction in that medium and raise
    StackError, because light beyond the critical angle has no direction in air. End such a sheet with an Interface of
    ior 1.

    Azimuths matter only with anisotropic facets: `phi_o` is that of the outgoing light from the tangent, `phi` that of
    a beam, both of directions of travel in radians; the incoming light travels along phi_o - dphi. Functions of such
    stacks know no grids and no other reflectance, and another thickness of a homogeneous medium on top only.

    `nodes` and `orders` are the solver's choices; `checks` is a dict of the errors that its checks found, the maxima
    over channels. A pickled function holds the arguments of its making, and is solved again when it is loaded, with
    the same result."""

    def __init__(self, stack: Stack | Callable[[], Stack], channels: list, method: _Method, made: tuple,
                 facets: ScatteringFunction | None = None):
        self._stack = stack  # or a function that makes the stack, for previews that never look at it
        self._channels = channels
        self._pool = method.pool
        self._made = made  # (callable, arguments) that make this function
        self._method = method
        self._facets = facets  # the fluxes of the stack with facets in place of mirrors, or None

    @property
    def stack(self) -> Stack:
        """The stack that this function belongs to."""
        return self._stack if isinstance(self._stack, Stack) else self._stack()

    def __reduce__(self):
        return self._made

    def __repr__(self) -> str:
        return (f"<ScatteringFunction of {self.stack.label}: {len(self._channels)} channels, {self.nodes} nodes, "
                f"{self.orders} orders>")

    @property
    def nodes(self) -> int:
        """Directions of the quadrature in a hemisphere, the most of any channel."""
        return max(solution.nodes for solution in self._channels)

    @property
    def orders(self) -> int:
        """Fourier orders in azimuth, the most of any channel."""
        return max(solution.orders for solution in self._channels)

    @property
    def checks(self) -> dict[str, float]:
        """The errors that the solver has measured, the worst of any channel, ideally 0: `quadrature` of the nodes'
        moments; `phase` of the phase functions' normalisation; `energy` that is gained, or lost without absorption;
        `reciprocity`, the relative asymmetry; `negativity`, the relative size of the most negative value; `azimuth` and
        `resolution`, the relative errors of the truncated orders and of the nodes."""
        names = ("quadrature", "phase", "energy", "reciprocity", "negativity", "azimuth", "resolution")
        return {name: max(getattr(s.checks, name) for s in self._channels) for name in names}

    @property
    def solutions(self) -> list:
        """The core's solutions, one per channel."""
        return list(self._channels)

    @property
    def pool(self) -> _core.ThreadPool:
        """The threads of this function."""
        return self._pool

    @property
    def _oriented(self) -> bool:
        """True if the core solved the stack with coupled azimuths."""
        return isinstance(self._channels[0], _core.OrientedSolution)

    def with_thickness(self, layer: int, taus) -> ScatteringFunction:
        """The same stack with the optical thickness `taus` of the layer with index `layer`, a number or one per
        channel, in [0, infinity], or in [0, 1e9] for a layer with a profile, and in [0, 1000] for flakes with their
        binder; much faster than a new solve. A stack of
        one channel takes any number of them. For the new `stack` see material.thickness.with_thickness. Raises
        StackError, ArgumentError and SolveError."""
        stack = self.stack
        layer = check_whole(layer, "layer", 0, len(stack.layers) - 1)
        medium = stack.layers[layer]
        if not isinstance(medium, Medium | OrientedLayer):
            raise ArgumentError(f"layer = {layer}: must be a medium, flakes or fibers, this one is of kind "
                                f"{medium.kind}")
        profile = isinstance(medium, Medium) and medium.profile is not None
        if self._oriented:
            stack.require_on_top(layer, "for another thickness above anisotropic facets")
        quantity = THICKNESS["tau"] if profile else TAU if isinstance(medium, Medium) else AMOUNT
        taus = quantity.check(taus, "taus")
        count = len(self._channels)
        if isinstance(taus, tuple) and len(taus) != count:
            if count > 1:
                raise ArgumentError(f"taus has {len(taus)} channels: must have {count} like the stack")
            count = len(taus)
        check_opaque(stack, layer, taus)
        changed = functools.cache(lambda: with_thickness(stack, layer, taus))

        made: dict = {}
        channels = []
        for index in range(count):
            own, tau = min(index, len(self._channels) - 1), channel(taus, index)
            solution = self._channels[own]
            key = (id(solution), tau)
            if key not in made:
                if profile and tau > 0.0 and medium.optics(own)[1] == 0.0:
                    # The core was given a clear layer in place of a profile without thickness
                    made[key] = self._method.channel(changed(), index)
                elif isinstance(solution, _core.OrientedSolution):
                    made[key] = or_solve_error(lambda s=solution, tau=tau: s.with_top_thickness(tau, self._pool))
                else:
                    made[key] = or_solve_error(lambda s=solution, tau=tau: s.with_thickness(layer, tau, self._pool))
            channels.append(made[key])
        facets = self._facets and self._facets.with_thickness(layer, taus)
        return self._derived(changed, channels, (ScatteringFunction.with_thickness, (self, layer, taus)), facets)

    def with_base_reflectance(self, reflectance: float) -> ScatteringFunction:
        """The same layers over a Lambert surface of another reflectance, in [0, 1], one for all channels; takes almost
        no time. Raises ArgumentError, also for another kind of base."""
        stack = self.stack
        stack.require_isotropic("another reflectance")
        if not isinstance(stack.base, Lambert):
            raise ArgumentError("reflectance: the base of the stack must be a Lambert surface")
        reflectance = check_number(reflectance, "reflectance", "must lie in [0, 1]", lambda r: 0.0 <= r <= 1.0)
        base = replace(stack.base, reflectance=reflectance)
        made = {id(solution): solution.with_reflectance(reflectance) for solution in self._channels}
        return self._derived(functools.cache(lambda: stack.with_facets(stack.layers, base)),
                             [made[id(solution)] for solution in self._channels],
                             (ScatteringFunction.with_base_reflectance, (self, reflectance)),
                             self._facets and self._facets.with_base_reflectance(reflectance))

    def _derived(self, stack: Callable[[], Stack], channels: list, made: tuple,
                 facets: ScatteringFunction | None) -> ScatteringFunction:
        return ScatteringFunction(stack, channels, self._method, made, facets)

    def brdf(self, mu_o, mu_i, dphi, side: str = "top", phi_o=0.0) -> np.ndarray:
        """BRDF in 1/sr, without specular parts. `mu_o`, `mu_i` in (0, 1], `dphi` in radians with 0 forward (light keeps
        its azimuth); arrays broadcast. Shape: broadcast + (channels,). Raises ValueError."""
        return self._evaluate(_core.Path.reflect, mu_o, mu_i, dphi, phi_o, side)

    def btdf(self, mu_o, mu_i, dphi, side: str = "top", phi_o=0.0) -> np.ndarray:
        """BTDF in 1/sr, without unscattered light; arguments as for brdf, light enters on `side`."""
        return self._evaluate(_core.Path.transmit, mu_o, mu_i, dphi, phi_o, side)

    def grid(self, path: str, mu_o, mu_i, dphi, side: str = "top") -> np.ndarray:
        """BRDF (`path` "reflect") or BTDF ("transmit") on a product grid, shape (o, i, dphi, channels)."""
        self.stack.require_isotropic("a grid of directions")
        lists = [cosines(finite_list(mu_o, "mu_o"), "mu_o"), cosines(finite_list(mu_i, "mu_i"), "mu_i")]
        azimuths = finite_list(dphi, "dphi")
        where = path_of(path)
        self._check_below(where, side)
        return self._by_channel(
            lambda s: s.grid(side_of(side), where, *lists, azimuths, self._pool))

    def to_xarray(self, mu_o=None, mu_i=None, dphi=None):
        """An xarray.Dataset on a product grid, by default 20 cosines from .05 to 1 for each direction and 13 azimuths
        from 0 to pi: `brdf` (side, mu_o, mu_i, dphi, channel) and `reflectance` (side, mu_i, channel), and for sheets
        `btdf` and `transmittance`. Axes have coordinates, and units are attributes. `side` is that on which light
        enters. Raises ExtraMissing without xarray, and ArgumentError."""
        return labelled.dataset(self, mu_o, mu_i, dphi)

    def reflectance(self, mu0, side: str = "top", parts: bool = False, phi=0.0):
        """Hemispherical reflectance for a beam at cosine `mu0`, or "diffuse" for uniform diffuse light. Shape: that of
        mu0 + (channels,), broadcast with `phi`. With `parts` the pair (without specular reflection, specular
        reflection). Raises ValueError."""
        scattered, mirrored, _, _ = self._fluxes(mu0, side, phi)
        return (scattered, mirrored) if check_flag(parts, "parts") else scattered + mirrored

    def transmittance(self, mu0, side: str = "top", parts: bool = False, phi=0.0):
        """Total transmittance, the unscattered beam included; with `parts` the pair (diffuse, direct)."""
        _, _, diffuse, direct = self._fluxes(mu0, side, phi)
        return (diffuse, direct) if check_flag(parts, "parts") else diffuse + direct

    def lost_by_facets(self, mu0) -> np.ndarray | None:
        """What facets that are solved as mirrors reflect less than these, negative where they reflect more: the
        difference of the fluxes reflected to the top, shape of mu0 + (channels,); None if all mirrors are smooth."""
        return None if self._facets is None else self._lost(mu0, *self._solved_fluxes(mu0, "top")[:2])

    def _lost(self, mu0, scattered: np.ndarray, mirrored: np.ndarray) -> np.ndarray:
        """lost_by_facets, with the fluxes that are reflected to the top."""
        assert self._facets is not None
        return scattered + mirrored - sum(self._facets._solved_fluxes(mu0, "top")[:2])

    def absorption(self, mu0, side: str = "top", phi=0.0) -> np.ndarray:
        """The absorbed share of the incident flux: 1 - reflectance - transmittance."""
        return 1.0 - sum(self._fluxes(mu0, side, phi))

    def _by_channel(self, call) -> np.ndarray:
        done = {}
        for solution in self._channels:
            if id(solution) not in done:
                done[id(solution)] = or_solve_error(lambda s=solution: call(s))
        return np.stack([done[id(solution)] for solution in self._channels], axis=-1)

    def _evaluate(self, path, mu_o, mu_i, dphi, phi_o, side: str) -> np.ndarray:
        self._check_below(path, side)
        names = ("mu_o", "mu_i", "dphi", "phi_o")
        arrays = broadcast([_cosines(mu_o, "mu_o"), _cosines(mu_i, "mu_i"), finite_array(dphi, "dphi")], names[:3])
        arrays = broadcast([*arrays, finite_array(phi_o, "phi_o")], names)
        flat = [_flat(array) for array in arrays[:4 if self._oriented else 3]]
        values = self._by_channel(lambda s: s.points(side_of(side), path, *flat, self._pool))
        return values.reshape(*arrays[0].shape, len(self._channels))

    def _check_below(self, path, side: str) -> None:
        """Raises StackError for directions below a sheet that does not end in air."""
        if side_of(side) == _core.Side.bottom or path == _core.Path.transmit:
            self.stack.require_air_below()

    def _fluxes(self, mu0, side: str, phi=0.0):
        """(scattered, mirrored, diffusely and directly transmitted), where mirrors have the energy of facets."""
        scattered, mirrored, diffuse, direct = self._solved_fluxes(mu0, side, phi)
        if self._facets is not None and side == "top":
            scattered, mirrored = sharp_facets.take_lost(scattered, mirrored, self._lost(mu0, scattered, mirrored))
        return scattered, mirrored, diffuse, direct

    def _solved_fluxes(self, mu0, side: str, phi=0.0):
        where = side_of(side)
        self._check_below(_core.Path.reflect, side)
        if isinstance(mu0, str):
            if mu0 != "diffuse":
                raise ArgumentError(f"mu0 = {quoted(mu0)}: must be a cosine in (0, 1] or 'diffuse'")
            def call(s):
                f = s.diffuse_fluxes(where, self._pool)
                return np.array([f.reflected[0], f.mirrored[0], f.transmitted[0], f.direct[0]])
        else:
            arrays = broadcast([_cosines(mu0, "mu0"), finite_array(phi, "phi")], ("mu0", "phi"))
            flat = [_flat(array) for array in arrays[:2 if self._oriented else 1]]
            def call(s):
                f = s.fluxes(where, *flat, self._pool)
                return np.array([f.reflected, f.mirrored, f.transmitted, f.direct]).reshape(4, *arrays[0].shape)
        return tuple(self._by_channel(call))


def _flat(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=float).ravel()


def _cosines(values, name: str) -> np.ndarray:
    return cosines(finite_array(values, name), name)

# SPDX-License-Identifier: GPL-3.0-or-later
# Written by `make stubs` from the compiled module.
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing
__all__: list[str] = ['Base', 'ClosureTable', 'Facets', 'Film', 'FilmedFlakes', 'FitViews', 'Fluxes', 'GradedMedium', 'Interface', 'LateralWalk', 'LeavingLight', 'LightDirections', 'MAX_CLOSURES', 'MeasuredStack', 'Medium', 'MovingFitOptions', 'NextEvent', 'OrientedSolution', 'Path', 'PhaseFunction', 'Searchlight', 'Selection', 'SelectionOptions', 'Side', 'SliceTarget', 'SlicesBelowMedium', 'Solution', 'SolveChecks', 'Stack', 'ThreadPool', 'WALK_BLOCK', 'Walk', 'WalkTarget', 'Window', 'adding_walk', 'count_sublayers', 'fit_moving', 'guided_transfer_walk', 'isotropic_walk', 'joined_media', 'lateral_flux', 'moving_albedos', 'moving_values', 'nearest_vertices', 'oriented_albedos', 'oriented_values', 'photon_walk', 'plane_scattering_walk', 'run_lateral_walk', 'run_walk', 'scattering_ode', 'scattering_walk', 'slab_scattering_walk', 'slices', 'solve', 'solve_at', 'solve_mean', 'solve_oriented', 'solve_oriented_at', 'solve_roughly', 'sublayers_of', 'transfer_walk']
class ThreadPool:
    """
    Threads for the core's calls; 0: one per hardware thread.
    """
    def __init__(self, threads: typing.SupportsInt | typing.SupportsIndex = 0) -> None:
        ...
    def stop(self) -> None:
        """
        From another thread: ends the work on these threads for good.
        """
    @property
    def threads(self) -> int:
        ...
class PhaseFunction:
    """
    A phase function, by kind and parameters.
    """
    def __init__(self, kind: str, *args) -> None:
        ...
    def evaluate(self, cosine: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> typing.Any:
        """
        4 pi p(cosine): the mean is 1.
        """
    def moment(self, order: typing.Annotated[numpy.typing.ArrayLike, numpy.int32]) -> typing.Any:
        """
        The Legendre moment chi_order.
        """
    def pdf(self, cosine: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> typing.Any:
        """
        Density of sample over the cosine.
        """
    def sample(self, u: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> typing.Any:
        """
        The cosine for u in [0, 1).
        """
    @property
    def peak(self) -> float:
        ...
class Medium:
    def __init__(self, albedo: typing.SupportsFloat | typing.SupportsIndex, tau: typing.SupportsFloat | typing.SupportsIndex, phase: str, *args) -> None:
        ...
class Facets:
    """
    The facets of a rough surface; alpha 0 is smooth; alpha_v is the width across the tangent, 0 as alpha. Equal by value, hashable.
    """
    def __eq__(self, arg0: Facets) -> bool:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, alpha: typing.SupportsFloat | typing.SupportsIndex = 0.0, distribution: str = 'ggx', correlated: bool = True, compensate: bool = True, alpha_v: typing.SupportsFloat | typing.SupportsIndex = 0.0, angle: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> None:
        ...
class Film:
    """
    Thin films on a 'medium', on a 'metal', or on both faces of a 'platelet'. `waves`: (weight, index below, [(index, thickness in wavelengths), ...] outermost first) by wavelength.
    """
    def __init__(self, ior_above: typing.SupportsFloat | typing.SupportsIndex, below: str, waves: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, complex | typing.SupportsComplex | typing.SupportsFloat | typing.SupportsIndex, collections.abc.Sequence[tuple[complex | typing.SupportsComplex | typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex]]]]) -> None:
        ...
class FilmedFlakes:
    """
    Flakes with films on a metal or a platelet, for flakes of the spread `alpha`.
    """
    def __init__(self, film: Film, alpha: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class Interface:
    def __init__(self, ior: typing.SupportsFloat | typing.SupportsIndex, facets: Facets = ..., film: Film = None) -> None:
        ...
class Base:
    @staticmethod
    def conductor(eta: typing.SupportsFloat | typing.SupportsIndex, k: typing.SupportsFloat | typing.SupportsIndex, facets: Facets = ..., film: Film = None) -> Base:
        ...
    @staticmethod
    def lambert(arg0: typing.SupportsFloat | typing.SupportsIndex) -> Base:
        ...
    @staticmethod
    def measured(low: typing.SupportsFloat | typing.SupportsIndex, high: typing.SupportsFloat | typing.SupportsIndex, steps: bytes) -> Base:
        """
        A measured material, see MeasuredReflection; `steps`: 16-bit integers, little-endian.
        """
    @staticmethod
    def none() -> Base:
        ...
    @staticmethod
    def principled(color: typing.SupportsFloat | typing.SupportsIndex, metallic: typing.SupportsFloat | typing.SupportsIndex, roughness: typing.SupportsFloat | typing.SupportsIndex, ior: typing.SupportsFloat | typing.SupportsIndex, specular: typing.SupportsFloat | typing.SupportsIndex, coat: typing.SupportsFloat | typing.SupportsIndex, coat_roughness: typing.SupportsFloat | typing.SupportsIndex, coat_ior: typing.SupportsFloat | typing.SupportsIndex, alpha: typing.SupportsFloat | typing.SupportsIndex) -> Base:
        """
        A Principled material by its sockets, indices relative to the medium above. Facets of `alpha` 0 are a mirror.
        """
    @staticmethod
    def retroreflector(reflectance: typing.SupportsFloat | typing.SupportsIndex, alpha: typing.SupportsFloat | typing.SupportsIndex) -> Base:
        ...
    @property
    def alpha(self) -> float:
        """
        The width of the facets.
        """
class Stack:
    def __init__(self, layers: collections.abc.Sequence[Medium | Interface | typing.Any], base: Base = ...) -> None:
        ...
class Side:
    """
    Members:

      top

      bottom
    """
    __members__: typing.ClassVar[dict[str, Side]]
    bottom: typing.ClassVar[Side]
    top: typing.ClassVar[Side]
    @typing.overload
    def __eq__(self, other: Side) -> bool:
        ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool:
        ...
    def __getstate__(self) -> int:
        ...
    def __hash__(self) -> int:
        ...
    def __index__(self) -> int:
        ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __int__(self) -> int:
        ...
    @typing.overload
    def __ne__(self, other: Side) -> bool:
        ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def name(self) -> str:
        ...
    @property
    def value(self) -> int:
        ...
class Path:
    """
    Members:

      reflect

      transmit
    """
    __members__: typing.ClassVar[dict[str, Path]]
    reflect: typing.ClassVar[Path]
    transmit: typing.ClassVar[Path]
    @typing.overload
    def __eq__(self, other: Path) -> bool:
        ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool:
        ...
    def __getstate__(self) -> int:
        ...
    def __hash__(self) -> int:
        ...
    def __index__(self) -> int:
        ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __int__(self) -> int:
        ...
    @typing.overload
    def __ne__(self, other: Path) -> bool:
        ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def name(self) -> str:
        ...
    @property
    def value(self) -> int:
        ...
class SolveChecks:
    @property
    def azimuth(self) -> float:
        ...
    @property
    def energy(self) -> float:
        ...
    @property
    def negativity(self) -> float:
        ...
    @property
    def phase(self) -> float:
        ...
    @property
    def quadrature(self) -> float:
        ...
    @property
    def reciprocity(self) -> float:
        ...
    @property
    def resolution(self) -> float:
        ...
class Fluxes:
    @property
    def direct(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
    @property
    def mirrored(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
    @property
    def reflected(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
    @property
    def transmitted(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
class Solution:
    def diffuse_fluxes(self, side: Side, pool: ThreadPool) -> Fluxes:
        ...
    def fluxes(self, side: Side, mu: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> Fluxes:
        ...
    def grid(self, side: Side, path: Path, mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], mu_i: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def points(self, side: Side, path: Path, mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], mu_i: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def with_reflectance(self, reflectance: typing.SupportsFloat | typing.SupportsIndex) -> Solution:
        ...
    def with_thickness(self, layer: typing.SupportsInt | typing.SupportsIndex, tau: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> Solution:
        ...
    @property
    def checks(self) -> SolveChecks:
        ...
    @property
    def node_cosines(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
    @property
    def node_weights(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
    @property
    def nodes(self) -> int:
        ...
    @property
    def orders(self) -> int:
        ...
class OrientedSolution:
    def diffuse_fluxes(self, side: Side, pool: ThreadPool) -> Fluxes:
        ...
    def fluxes(self, side: Side, mu: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], phi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> Fluxes:
        ...
    def points(self, side: Side, path: Path, mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], mu_i: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], phi_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
    def slices(self, mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], phi_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], mu_i: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> tuple[typing.Annotated[numpy.typing.NDArray[numpy.float32], "[m, n]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]]:
        """
        (f mu_i [light, view], albedo [view], specular reflectance [view]), see oriented_slices
        """
    def with_top_thickness(self, tau: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> OrientedSolution:
        ...
    @property
    def checks(self) -> SolveChecks:
        ...
    @property
    def nodes(self) -> int:
        ...
    @property
    def orders(self) -> int:
        ...
class SlicesBelowMedium:
    def __init__(self, bare: OrientedSolution, mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], phi_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], mu_i: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> None:
        ...
    def of(self, solution: OrientedSolution, pool: ThreadPool) -> tuple[typing.Annotated[numpy.typing.NDArray[numpy.float32], "[m, n]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]]:
        """
        As OrientedSolution.slices, of another thickness on top.
        """
class SliceTarget:
    @property
    def albedo(self) -> float:
        ...
    @property
    def column(self) -> int:
        ...
    @property
    def norm2(self) -> float:
        ...
    @property
    def weight(self) -> float:
        ...
    @weight.setter
    def weight(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class SelectionOptions:
    def __init__(self) -> None:
        ...
    @property
    def closures(self) -> int:
        ...
    @closures.setter
    def closures(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def overshoot(self) -> int:
        ...
    @overshoot.setter
    def overshoot(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def penalty(self) -> list[float]:
        ...
    @penalty.setter
    def penalty(self, arg0: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]) -> None:
        ...
    @property
    def swap_passes(self) -> int:
        ...
    @swap_passes.setter
    def swap_passes(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def target_error(self) -> float:
        ...
    @target_error.setter
    def target_error(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def worst_share(self) -> float:
        ...
    @worst_share.setter
    def worst_share(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class Selection:
    @property
    def closures(self) -> list[int]:
        ...
    @property
    def mean_error(self) -> float:
        ...
    @property
    def worst_error(self) -> float:
        ...
class ClosureTable:
    def __init__(self, values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], solid_angle: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], albedo: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        ...
    def fit(self, targets: collections.abc.Sequence[SliceTarget], chosen: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], pool: ThreadPool) -> tuple:
        ...
    def select(self, targets: collections.abc.Sequence[SliceTarget], options: SelectionOptions, candidates: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], fixed: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], pool: ThreadPool) -> Selection:
        ...
    def targets(self, slices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], albedo: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], pool: ThreadPool) -> list[SliceTarget]:
        ...
class MovingFitOptions:
    retro: bool
    def __init__(self) -> None:
        ...
    @property
    def following(self) -> float:
        ...
    @following.setter
    def following(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def iterations(self) -> int:
        ...
    @iterations.setter
    def iterations(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def lobes(self) -> int:
        ...
    @lobes.setter
    def lobes(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def most_change(self) -> float:
        ...
    @most_change.setter
    def most_change(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def stiffness(self) -> float:
        ...
    @stiffness.setter
    def stiffness(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class LightDirections:
    def __init__(self, mu: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
class FitViews:
    def __init__(self, mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], phi_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], mirrored: bool) -> None:
        ...
class Walk:
    pass
class WalkTarget:
    """
    The quantity that a walk estimates; flux: over all outgoing directions.
    """
    def __init__(self, mu_o: typing.SupportsFloat | typing.SupportsIndex, mu_i: typing.SupportsFloat | typing.SupportsIndex, dphi: typing.SupportsFloat | typing.SupportsIndex, side: Side = ..., path: Path = ..., flux: bool = False, phi: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> None:
        ...
class NextEvent:
    """
    Members:

      from_both_ends

      fitting

      along_flight

      at_collision
    """
    __members__: typing.ClassVar[dict[str, NextEvent]]
    along_flight: typing.ClassVar[NextEvent]
    at_collision: typing.ClassVar[NextEvent]
    fitting: typing.ClassVar[NextEvent]
    from_both_ends: typing.ClassVar[NextEvent]
    @typing.overload
    def __eq__(self, other: NextEvent) -> bool:
        ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool:
        ...
    def __getstate__(self) -> int:
        ...
    def __hash__(self) -> int:
        ...
    def __index__(self) -> int:
        ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __int__(self) -> int:
        ...
    @typing.overload
    def __ne__(self, other: NextEvent) -> bool:
        ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def name(self) -> str:
        ...
    @property
    def value(self) -> int:
        ...
class GradedMedium:
    """
    A slab whose albedo times phase function is linear between knots.
    """
    @staticmethod
    def homogeneous(albedo: typing.SupportsFloat | typing.SupportsIndex, tau: typing.SupportsFloat | typing.SupportsIndex, phase: str, *args) -> GradedMedium:
        ...
    def __init__(self, knots: collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex, tuple]]) -> None:
        ...
    def over(self, reflectance: typing.SupportsFloat | typing.SupportsIndex) -> GradedMedium:
        """
        The same slab on a Lambert surface.
        """
    @property
    def tau(self) -> float:
        ...
class MeasuredStack:
    def __init__(self, stack: Stack, extinction: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], thickness: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], whole_tau: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]) -> None:
        """
        A stack of homogeneous layers with, by layer, extinction (1/mm) and thickness (mm). whole_tau: the optical thickness of the medium, and for slices of a graded medium that of the whole.
        """
class LeavingLight:
    def at(self, q: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], pool: ThreadPool) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def density(self, r: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], pool: ThreadPool) -> numpy.typing.NDArray[numpy.float64]:
        ...
    def inside(self, r: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], pool: ThreadPool) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @property
    def at_entry(self) -> float:
        ...
    @property
    def direct(self) -> float:
        ...
    @property
    def distance(self) -> float:
        ...
    @property
    def flux(self) -> float:
        ...
    @property
    def square_distance(self) -> float:
        ...
class Searchlight:
    def __init__(self, stack: MeasuredStack, mu: typing.SupportsFloat | typing.SupportsIndex, preview: bool) -> None:
        ...
    def advance(self, pool: ThreadPool) -> None:
        ...
    @property
    def done(self) -> bool:
        ...
    @property
    def frequencies(self) -> int:
        ...
    @property
    def nodes(self) -> int:
        ...
    @property
    def progress(self) -> float:
        ...
    @property
    def reflected(self) -> LeavingLight:
        ...
    @property
    def transmitted(self) -> LeavingLight:
        ...
class LateralWalk:
    @property
    def mirrored(self) -> float:
        ...
    @property
    def unscattered(self) -> float:
        ...
class Window:
    """
    The weighted neighbours of the points of a map.
    """
    def __init__(self, numbers: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], weights: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], places: typing.Annotated[numpy.typing.ArrayLike, numpy.float32]) -> None:
        """
        numbers [neighbour, point], below 0 where there is none; weights [neighbour, point] and places along two tangents [neighbour, point, 2], or without the axis of points if they are the same for all
        """
    def mean(self, values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], pool: ThreadPool) -> numpy.typing.NDArray[numpy.float64]:
        """
        The weighted mean of values [point, n] over the window of each point.
        """
    def regression(self, guides: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], ridge: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
        """
        (fit [point, n], share [point] of the own value in it), see window_regression
        """
def adding_walk(stack: Stack, target: WalkTarget, pool: ThreadPool) -> tuple[Walk, float]:
    """
    The walk and the error of its tables.
    """
def count_sublayers(stack: Stack, tolerance: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> int:
    """
    The number of layers of the stack as it is solved.
    """
def fit_moving(slices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], broad: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], views: FitViews, light: LightDirections, solid_angle: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], options: MovingFitOptions, first_row: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], pool: ThreadPool) -> numpy.typing.NDArray[numpy.float64]:
    ...
def guided_transfer_walk(medium: GradedMedium, mu_o: typing.SupportsFloat | typing.SupportsIndex, mu_i: typing.SupportsFloat | typing.SupportsIndex, dphi: typing.SupportsFloat | typing.SupportsIndex) -> Walk:
    """
    A photon walk guided by the adjoint internal field of a coarse solution.
    """
def isotropic_walk(medium: GradedMedium, mu_o: typing.SupportsFloat | typing.SupportsIndex, mu_i: typing.SupportsFloat | typing.SupportsIndex) -> Walk:
    """
    The scattering equation of isotropic media, guided by tables.
    """
def joined_media(stack: Stack) -> GradedMedium:
    """
    The media of a stack and its Lambert base as one graded medium.
    """
def lateral_flux(stack: MeasuredStack, mu: typing.SupportsFloat | typing.SupportsIndex, q: typing.SupportsFloat | typing.SupportsIndex, nodes: typing.SupportsInt | typing.SupportsIndex, azimuths: typing.SupportsInt | typing.SupportsIndex, bend: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> tuple[float, float]:
    """
    (reflected, transmitted) at one lateral frequency and a given resolution; truncated peaks count as unscattered.
    """
def moving_albedos(shapes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    ...
def moving_values(shapes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], light: LightDirections) -> numpy.typing.NDArray[numpy.float64]:
    ...
def nearest_vertices(positions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], along: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], most: typing.SupportsInt | typing.SupportsIndex, pool: ThreadPool) -> numpy.typing.NDArray[numpy.int32]:
    """
    The nearest of the neighbours `along` [vertex, m] and of their neighbours: numbers [vertex, most].
    """
def oriented_albedos(shapes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], phi_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    ...
def oriented_values(shapes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], phi_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], light: LightDirections) -> numpy.typing.NDArray[numpy.float64]:
    ...
def photon_walk(stack: Stack, depth_knots: collections.abc.Sequence[collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex]]], mu_i: typing.SupportsFloat | typing.SupportsIndex) -> LateralWalk:
    ...
def plane_scattering_walk(stack: Stack, depth_knots: collections.abc.Sequence[collections.abc.Sequence[tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex]]], mu_i: typing.SupportsFloat | typing.SupportsIndex) -> LateralWalk:
    ...
def run_lateral_walk(walk: LateralWalk, radii: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], frequencies: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], seed: typing.SupportsInt | typing.SupportsIndex, first_block: typing.SupportsInt | typing.SupportsIndex, last_block: typing.SupportsInt | typing.SupportsIndex, pool: ThreadPool) -> tuple[tuple, tuple, int, int]:
    """
    (above, below, count, events) of blocks of WALK_BLOCK samples; a side is (within, within_squares, moments, products).
    """
def run_walk(walk: Walk, seed: typing.SupportsInt | typing.SupportsIndex, first_block: typing.SupportsInt | typing.SupportsIndex, last_block: typing.SupportsInt | typing.SupportsIndex, pool: ThreadPool) -> tuple[float, float, float, int, int]:
    """
    (sum, squares, largest, count, events) over blocks of WALK_BLOCK samples.
    """
def scattering_ode(medium: GradedMedium, mu: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], pool: ThreadPool, nodes: typing.SupportsInt | typing.SupportsIndex = 32, tolerance: typing.SupportsFloat | typing.SupportsIndex = 1e-08) -> dict:
    """
    The differential form: brdf and btdf [mu_o, mu_i, dphi], fluxes by mu_i.
    """
def scattering_walk(stack: Stack, target: WalkTarget) -> Walk:
    """
    The most efficient of these for isotropic and for other media.
    """
def slab_scattering_walk(medium: GradedMedium, mu_o: typing.SupportsFloat | typing.SupportsIndex, mu_i: typing.SupportsFloat | typing.SupportsIndex, dphi: typing.SupportsFloat | typing.SupportsIndex) -> Walk:
    """
    The scattering equation, guided by closed forms alone.
    """
def slices(solutions: collections.abc.Sequence[Solution], sights: collections.abc.Sequence[tuple[Side, Path]], mu_o: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], mu_i: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], dphi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], pool: ThreadPool) -> tuple:
    ...
def solve(stack: Stack, tolerance: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> Solution:
    ...
def solve_at(stack: Stack, nodes: typing.SupportsInt | typing.SupportsIndex, azimuth_tolerance: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool, thinnest: typing.SupportsFloat | typing.SupportsIndex = 1.0) -> Solution:
    """
    Solves at a given resolution, without refinement; the checks give its accuracy.
    """
def solve_mean(stack: Stack, tolerance: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> Solution:
    """
    Solves the mean over azimuths alone: only fluxes can be asked.
    """
def solve_oriented(stack: Stack, tolerance: typing.SupportsFloat | typing.SupportsIndex, pool: ThreadPool) -> OrientedSolution:
    """
    Solves a stack of isotropic or anisotropic facets with coupled azimuths.
    """
def solve_oriented_at(stack: Stack, tolerance: typing.SupportsFloat | typing.SupportsIndex, nodes: typing.SupportsInt | typing.SupportsIndex, orders: typing.SupportsInt | typing.SupportsIndex, fineness: typing.SupportsInt | typing.SupportsIndex, pool: ThreadPool) -> OrientedSolution:
    """
    As solve_oriented, at a given resolution.
    """
def solve_roughly(stack: Stack, tolerance: typing.SupportsFloat | typing.SupportsIndex, nodes: typing.SupportsInt | typing.SupportsIndex, pool: ThreadPool) -> Solution:
    ...
def sublayers_of(medium: ..., coarseness: typing.SupportsFloat | typing.SupportsIndex) -> list[Medium]:
    """
    The homogeneous sublayers that replace a graded medium.
    """
def transfer_walk(stack: Stack, target: WalkTarget, next_event: NextEvent = ...) -> Walk:
    ...
MAX_CLOSURES: int = 24
WALK_BLOCK: int = 4096
__version__: str

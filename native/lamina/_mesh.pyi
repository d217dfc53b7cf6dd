# SPDX-License-Identifier: GPL-3.0-or-later
# Written by `make stubs` from the compiled module.
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing
__all__: list[str] = ['Boundary', 'Fall', 'Grid', 'Lamp', 'Options', 'PhotonSource', 'Scene', 'Solid', 'SurfaceTexels', 'Surroundings', 'corner_points', 'photons_to_texels', 'texels', 'walk_to_exits', 'walk_to_lights']
class Fall:
    """
    How grains fall: orthonormal directions, and the wind relative to the speed of the fall.
    """
    def __init__(self, up: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], across1: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], across2: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], wind1: typing.SupportsFloat | typing.SupportsIndex, wind2: typing.SupportsFloat | typing.SupportsIndex, sin_spread: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    def open_share(self, arg0: typing.SupportsFloat | typing.SupportsIndex, arg1: typing.SupportsFloat | typing.SupportsIndex, arg2: typing.SupportsFloat | typing.SupportsIndex) -> float:
        ...
class Options:
    def __init__(self, rays: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex, two_sided: bool, offset: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class Scene:
    """
    Meshes (vertices, triangles); dust settles on the first.
    """
    def __init__(self, meshes: collections.abc.Sequence[tuple[typing.Annotated[numpy.typing.ArrayLike, numpy.float32], typing.Annotated[numpy.typing.ArrayLike, numpy.uint32]]], threads: typing.SupportsInt | typing.SupportsIndex, go_on: collections.abc.Callable) -> None:
        ...
    def arrivals(self, fall: Fall, positions: numpy.typing.NDArray[numpy.float32], normals: numpy.typing.NDArray[numpy.float32], first_number: typing.SupportsInt | typing.SupportsIndex, options: Options) -> tuple:
        """
        (shares, rays traced); one share per point, or front and back
        """
    def convexities(self, positions: numpy.typing.NDArray[numpy.float32], normals: numpy.typing.NDArray[numpy.float32], first_number: typing.SupportsInt | typing.SupportsIndex, options: Options, reach: typing.SupportsFloat | typing.SupportsIndex) -> tuple:
        """
        (convexities, rays traced)
        """
    def exposures(self, positions: numpy.typing.NDArray[numpy.float32], normals: numpy.typing.NDArray[numpy.float32], first_number: typing.SupportsInt | typing.SupportsIndex, options: Options, reach: typing.SupportsFloat | typing.SupportsIndex) -> tuple:
        """
        (exposures, rays traced)
        """
    def grains(self, fall: Fall, corner: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], edge1: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], edge2: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        Counts of grains: (front, back, stopped by each mesh, missed)
        """
    @property
    def bytes(self) -> int:
        ...
class Solid:
    """
    A closed mesh, lengths in mm, and the threads that walk in it.
    """
    def __init__(self, vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.uint32], threads: typing.SupportsInt | typing.SupportsIndex, go_on: collections.abc.Callable, opaque: collections.abc.Sequence[bool] = []) -> None:
        ...
    def clearance(self, place: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> float:
        """
        A distance in mm up to which there is no surface around a place.
        """
    def distances(self, positions: numpy.typing.NDArray[numpy.float32], within: typing.SupportsFloat | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float32]:
        """
        Distances in mm from places to the surface, `within` where that is farther.
        """
    def exposures(self, positions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], normals: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.int8]:
        """
        Of each start of walks: 0 where light can enter, 1 inside another part of the mesh, 2 where the normal points inwards, 3 on an opaque face.
        """
    def stand_among(self, vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.uint32], albedo: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], emission: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], go_on: collections.abc.Callable, links: tuple[typing.Annotated[numpy.typing.ArrayLike, numpy.uint64], typing.Annotated[numpy.typing.ArrayLike, numpy.uint64], typing.Annotated[numpy.typing.ArrayLike, numpy.uint8], typing.SupportsInt | typing.SupportsIndex] | None = None) -> None:
        """
        Put opaque things around the solid, with the albedo and the emitted radiance of each triangle. `links`: (the linkings whose light each triangle takes, as bits, those that light it, the linking of what it emits, the linkings that light the solid); without them all light meets everything.
        """
    @property
    def bytes(self) -> int:
        ...
class Grid:
    """
    Coefficients in voxels [x, y, z] of a box in mm.
    """
    @staticmethod
    def of_coefficients(voxels: numpy.typing.NDArray[numpy.uint16], low: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], high: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], smooth: bool, g: typing.SupportsFloat | typing.SupportsIndex) -> Grid:
        """
        Voxels are six halves, as bits: sigma_s and sigma_a of three channels, in 1/mm.
        """
    @staticmethod
    def of_mixture(voxels: numpy.typing.NDArray[numpy.uint16], low: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], high: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], smooth: bool, palette: collections.abc.Sequence[tuple[typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], typing.SupportsFloat | typing.SupportsIndex]]) -> Grid:
        """
        Voxels are places in the palette, 0 to 65535; the palette is a list of (sigma_s, sigma_a, g).
        """
class Boundary:
    """
    The boundary of a solid in air.
    """
    def __init__(self, ior: typing.SupportsFloat | typing.SupportsIndex, alpha: typing.SupportsFloat | typing.SupportsIndex, distribution: str) -> None:
        ...
class Lamp:
    """
    A lamp of unit strength, lengths in mm.
    """
    @staticmethod
    def area(centre: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], first: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], second: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], ellipse: bool) -> Lamp:
        ...
    @staticmethod
    def distant(towards: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], cosine: typing.SupportsFloat | typing.SupportsIndex) -> Lamp:
        ...
    @staticmethod
    def sphere(centre: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], radius: typing.SupportsFloat | typing.SupportsIndex) -> Lamp:
        ...
    @staticmethod
    def spot(centre: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], radius: typing.SupportsFloat | typing.SupportsIndex, axis: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"], cosine: typing.SupportsFloat | typing.SupportsIndex, blend: typing.SupportsFloat | typing.SupportsIndex) -> Lamp:
        ...
    def linked(self, linking: typing.SupportsInt | typing.SupportsIndex) -> Lamp:
        """
        The lamp with light of this linking, 0 to 63.
        """
class Surroundings:
    """
    Radiance by direction; without a table, 1 everywhere.
    """
    @typing.overload
    def __init__(self) -> None:
        ...
    @typing.overload
    def __init__(self, table: numpy.typing.NDArray[numpy.float32]) -> None:
        ...
class PhotonSource:
    """
    Where the light of a lamp meets a solid.
    """
    def __init__(self, solid: Solid, lamp: Lamp, grid: Grid, boundary: Boundary) -> None:
        ...
class SurfaceTexels:
    """
    The parts of a surface below the texels of an image.
    """
    def __init__(self, solid: Solid, uvs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], numbers: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], positions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], normals: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        """
        `numbers`: of each texel's position, -1 without one, rows from the bottom.
        """
    @property
    def areas(self) -> list[float]:
        """
        In mm^2, by position.
        """
def corner_points(triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.uint32], normals: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], cosine: typing.SupportsFloat | typing.SupportsIndex, vertices: typing.SupportsInt | typing.SupportsIndex) -> tuple:
    """
    (point of each corner, vertex of each point, first corner of each point). The corners at a vertex share a point across edges where the cosine between the triangles' normals, or with three normals per triangle between the corners' own normals, is at least `cosine`.
    """
def photons_to_texels(solid: Solid, grid: Grid, boundary: Boundary, source: PhotonSource, texels: SurfaceTexels, first: typing.SupportsInt | typing.SupportsIndex, count: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex) -> tuple:
    """
    (sums [position, (channels, moments)], squares, counts [1, 5]) of samples [first, first + count).
    """
def texels(uvs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], width: typing.SupportsInt | typing.SupportsIndex, height: typing.SupportsInt | typing.SupportsIndex, first_row: typing.SupportsInt | typing.SupportsIndex = 0, rows: typing.SupportsInt | typing.SupportsIndex | None = None) -> tuple:
    """
    (triangle, weights of corners 2 and 3) of each texel in the rows.
    """
def walk_to_exits(solid: Solid, grid: Grid, boundary: Boundary, positions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], normals: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], views: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None, first_number: typing.SupportsInt | typing.SupportsIndex, first_walk: typing.SupportsInt | typing.SupportsIndex, walks: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex, late_after: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"]) -> tuple:
    """
    (moments [point, channel, (w, w r, w r^2)], products [point, channel, 6], counts [point, (mirrored, lost, scatterings, collisions, rays)], late [point, channel, (w, w r)] of paths with more scatterings than `late_after` of their channel).
    """
def walk_to_lights(solid: Solid, grid: Grid, boundary: Boundary, positions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], normals: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], views: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None, first_number: typing.SupportsInt | typing.SupportsIndex, first_walk: typing.SupportsInt | typing.SupportsIndex, walks: typing.SupportsInt | typing.SupportsIndex, seed: typing.SupportsInt | typing.SupportsIndex, lamps: collections.abc.Sequence[Lamp], by_occluders: bool, surroundings: Surroundings) -> tuple:
    """
    (sums [point, lamp or last the surroundings, (channels, moments)], squares, counts).
    """

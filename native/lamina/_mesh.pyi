# SPDX-License-Identifier: GPL-3.0-or-later
# Written by `make stubs` from the compiled module.
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing
__all__: list[str] = ['Fall', 'Options', 'Scene', 'corner_points', 'texels']
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
def corner_points(triangles: typing.Annotated[numpy.typing.ArrayLike, numpy.uint32], normals: typing.Annotated[numpy.typing.ArrayLike, numpy.float32], cosine: typing.SupportsFloat | typing.SupportsIndex, vertices: typing.SupportsInt | typing.SupportsIndex) -> tuple:
    """
    (point of each corner, vertex of each point, first corner of each point). The corners at a vertex share a point across edges where the cosine between the triangles' normals, or with three normals per triangle between the corners' own normals, is at least `cosine`.
    """
def texels(uvs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], width: typing.SupportsInt | typing.SupportsIndex, height: typing.SupportsInt | typing.SupportsIndex, first_row: typing.SupportsInt | typing.SupportsIndex = 0, rows: typing.SupportsInt | typing.SupportsIndex | None = None) -> tuple:
    """
    (triangle, weights of corners 2 and 3) of each texel in the rows.
    """

# SPDX-License-Identifier: GPL-3.0-or-later
"""Light as the exponential of a quadratic function of the direction, from its moments over directions.

Of all positive functions of the direction with given moments, the exponential of a combination of the same terms has
the largest entropy. This closure is known from moment methods for transport (Minerbo 1978, JQSRT 20; Levermore 1996, J.
Stat. Phys. 83), there over the sphere. Here moments are cosine-weighted means over the directions that leave a surface.
Behind a smooth boundary, the function is multiplied by the share of light that the boundary lets out."""

from __future__ import annotations

import numpy as np

from ..common.fresnel import fresnel
from ..interior.problem import Surface
from ..walks.searchlight_moments import Measured
from .places import frames_about

_COSINES, _AZIMUTHS = 8, 16  # nodes: Gauss-Legendre; at equal distances over a turn
_RIDGE = 1e-3  # holds factors small that moments hardly determine, as for directions near the horizon
_STEEPEST = 20.0  # the largest length of the factors, up to which the nodes suffice
_BLOCK = 2048  # functions at a time, to limit memory
_STEPS, _CONVERGED = 60, 1e-5  # of Newton's method; largest decrement
_ROWS, _COLUMNS = (0, 1, 0, 1, 2), (0, 1, 1, 2, 0)  # of x^2, y^2, xy, yz and zx in the matrix w w^T


def even_moments(normals: np.ndarray, boundary: Surface) -> np.ndarray:
    """(points, 8): the moments of light of mean 1 that is the same in all directions, inside a smooth boundary."""
    even = _Rule(boundary).even[0]
    back = np.swapaxes(frames_about(normals), -1, -2)
    first, second = _turned(back, np.broadcast_to(even[:3], normals.shape), _matrix(even[3:], 1.0))
    return np.concatenate([first, second[..., _ROWS, _COLUMNS]], axis=-1)


def exponential(mean: np.ndarray, excess: Measured, normals: np.ndarray, boundary: Surface) -> np.ndarray:
    """The numbers of LitImages.lamp_changes, (points, sources, 9). `mean` of the light, (points, sources); `excess` of
    its moments over those of light that is the same in all directions, (points, sources, 8); `normals`: (points, 3)."""
    frames, rule = frames_about(normals)[:, None], _Rule(boundary)
    even, spread = rule.even
    first, second = _turned(frames, excess.value[..., :3], _matrix(excess.value[..., 3:], 0.0))
    local = np.concatenate([first, second[..., _ROWS, _COLUMNS]], axis=-1)
    # Noise is distributed over the moments as that of paths with directions of even light
    total = (excess.stderr[..., :3] ** 2).sum(axis=-1, keepdims=True)
    drawn = _less_noise(local, spread * total / spread[:3].sum(), np.maximum(mean, 0.0)[..., None], spread)
    wanted = np.clip(even + drawn, -1.0, 1.0).reshape(-1, 8)
    found = np.concatenate([rule.solved(wanted[start:start + _BLOCK]) for start in range(0, len(wanted), _BLOCK)])
    return _terms_of_object(frames, found.reshape(*mean.shape, 9))


def _less_noise(values: np.ndarray, variances: np.ndarray, light: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Values over the light, (points, sources, moments), with less noise; 0 without light. Each is drawn to the mean
    over the points of its source by the share of noise in the variance over the points (empirical Bayes). Points with
    more noise than the moments' `spread` count less."""
    is_lit = light > 0.0
    ratio = np.divide(values, light, out=np.zeros_like(values), where=is_lit)
    noise = np.divide(variances, light**2, out=np.zeros_like(values), where=is_lit)
    weight = is_lit / (spread + noise)
    weight /= np.maximum(weight.sum(axis=0), 1e-30)
    usual = (weight * ratio).sum(axis=0)
    signal = np.maximum((weight * ((ratio - usual) ** 2 - noise)).sum(axis=0), 0.0)
    share = np.divide(signal, signal + noise, out=np.zeros_like(values), where=signal + noise > 0.0)
    return is_lit * (usual + share * (ratio - usual))


def _terms_of_object(frames: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Factors of the terms in the object's axes, from those in axes about the normals."""
    half = np.array([1.0, 1.0, 0.5, 0.5, 0.5])
    matrix = _matrix(half * found[..., 3:8], found[..., 3] + found[..., 4])
    linear, square = _turned(np.swapaxes(frames, -1, -2), found[..., :3], matrix)
    last = square[..., 2, 2, None]  # z^2 = 1 - x^2 - y^2
    products = (square[..., _ROWS, _COLUMNS] - last * [1.0, 1.0, 0.0, 0.0, 0.0]) / half
    return np.concatenate([linear, products, found[..., 8:] + last], axis=-1)


def _matrix(products: np.ndarray, trace: np.ndarray | float) -> np.ndarray:
    """The symmetric matrix of xx, yy, xy, yz and zx, whose zz is such that it has this trace."""
    matrix = np.empty((*products.shape[:-1], 3, 3))
    matrix[..., _ROWS, _COLUMNS] = matrix[..., _COLUMNS, _ROWS] = products
    matrix[..., 2, 2] = trace - products[..., 0] - products[..., 1]
    return matrix


def _turned(frames: np.ndarray, vector: np.ndarray, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return (frames @ vector[..., None])[..., 0], frames @ matrix @ np.swapaxes(frames, -1, -2)


class _Rule:
    """A quadrature over the directions w of the hemisphere about z: x, y, z, x^2, y^2, xy, yz and zx of each."""

    def __init__(self, boundary: Surface):
        nodes, weights = np.polynomial.legendre.leggauss(_COSINES)
        z, turn = 0.5 * (nodes + 1.0), 2.0 * np.pi * (np.arange(_AZIMUTHS) + 0.5) / _AZIMUTHS
        passed = 1.0 - fresnel(z, boundary.ior) if boundary.is_smooth else 1.0
        self._weights = np.repeat(weights * z * passed, _AZIMUTHS) / _AZIMUTHS
        across = np.sqrt(1.0 - z * z)
        x, y = (np.outer(across, ratio).ravel() for ratio in (np.cos(turn), np.sin(turn)))
        z = np.repeat(z, _AZIMUTHS)
        self._terms = np.stack([x, y, z, x * x, y * y, x * y, y * z, z * x])
        self._squares = (self._terms[:, None] * self._terms).reshape(64, -1).T
        _, mean, square = self.moments(np.zeros((1, 8)))
        self.even = mean[0], np.diag(square[0]) - mean[0] ** 2  # of even light: mean terms and their variances

    def moments(self, steepness: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(the cosine-weighted mean Z of exp(steepness . terms), mean terms, mean products of two terms, both by the
        exponential)."""
        light = self._weights * np.exp(steepness @ self._terms)
        total = light.sum(axis=1)
        light /= total[:, None]
        return total, light @ self._terms.T, (light @ self._squares).reshape(-1, 8, 8)

    def solved(self, wanted: np.ndarray) -> np.ndarray:
        """(functions, 9): factors of the terms, and of 1, for light of mean 1 with the `wanted` mean terms. Newton's
        method for the minimum of the convex function log Z - steepness . wanted, with short steps far from it."""
        found, left = np.zeros_like(wanted), np.arange(len(wanted))
        for _ in range(_STEPS):
            _, mean, square = self.moments(found[left])
            gradient = wanted[left] - mean - _RIDGE * found[left]
            spread = square - mean[:, :, None] * mean[:, None] + _RIDGE * np.eye(8)
            step = np.linalg.solve(spread, gradient[..., None])[..., 0]
            decrement = np.sqrt(np.maximum((step * gradient).sum(axis=1), 0.0))
            before = found[left]
            found[left] = _within(before + step / (1.0 + np.where(decrement > 0.25, decrement, 0.0))[:, None])
            left = left[(decrement > _CONVERGED) & (found[left] != before).any(axis=1)]
            if not left.size:
                break
        return np.column_stack([found, -np.log(self.moments(found)[0])])


def _within(factors: np.ndarray) -> np.ndarray:
    """Factors of at most the length _STEEPEST."""
    length = np.linalg.norm(factors, axis=1, keepdims=True)
    return factors * np.minimum(1.0, _STEEPEST / np.maximum(length, 1e-12))

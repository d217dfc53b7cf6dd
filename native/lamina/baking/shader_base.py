# SPDX-License-Identifier: GPL-3.0-or-later
"""A base that another shader renders: the weight of that shader's light below the layers.

The shader's scattering function is unknown, so the light that it sends through the layers is approximate: its own light
towards the viewer, times a weight that depends on the view. For a base of mean reflectance c the weight is
w / (1 - c r), see geometric_series, where r is the share of diffuse light that the layers reflect back to the base. For
a Lambert surface w is known exactly: the directional albedo of base_texture's A. Light from a metal crosses the layers
twice at nearly the same angle, and has another w. The table holds the geometric mean of both, whose error is as large
for a Lambert surface as for a rough metal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..closures.axes import column_angles
from ..closures.closure_table import LightGrid, view_cosines
from ..common.progress import Progress
from ..kinds.bases import Conductor, Lambert, ShaderBase
from ..kinds.fields import channel
from ..kinds.table import BASE_WEIGHT, THROWN_BACK
from ..material.layers import Medium
from ..material.stack import Stack
from ..solver.solve import solve_with_mirrors
from .base_texture import TexturedBase
from .mixture import FittedMixture, Mixture, norms, relative
from .slices import Slices, SolvedRows

METAL = Conductor(facing=0.9, grazing=0.9, alpha=0.3)  # like aluminium
REFLECTANCES = (0.2, 0.5, 0.8)  # of Lambert surfaces for which the error is measured
UNKNOWN = 0.5  # reflectance of a base that nobody knows
MEASURED_ROWS = 5  # of thickness, for the metal
# Largest factor between the weights for a Lambert surface and for the metal.
MOST = 4.0
LUMINANCE = (0.2126, 0.7152, 0.0722)  # of linear Rec. 709, as Blender's node for grey values has them


def on_lambert(stack: Stack) -> Stack:
    """The stack with a Lambert base in place of a ShaderBase; any other stack as it is."""
    if not isinstance(stack.base, ShaderBase):
        return stack
    return stack.with_facets(stack.layers, Lambert(stack.base.reflectance))


def shader_parts(stack: Stack, solved: SolvedRows, black: Slices, dark: FittedMixture, base: TexturedBase,
                 grid: LightGrid, quality: str, threads: int, step: Progress) -> tuple[dict[str, Mixture], dict]:
    """(the table's parts, the report's `base_error`) of a stack on a ShaderBase. `black`: its slices over a black base,
    and `dark` their fit.

    The report, worst relative errors over thicknesses of the energy that leaves under a uniform sky: `lambert` and
    `metal`, where the node group has the color of the base as the reflectance; `unknown`, over both where the group
    takes UNKNOWN instead. These are errors of the luminance. `color`: the worst of both in one channel, because the
    light of the shader has one weight for all channels."""
    rows = sorted({round(row) for row in np.linspace(0, len(solved.rows) - 1, MEASURED_ROWS)})
    step(0.0, "Solving the stack on metal")
    metal = _reflected(_thicknesses(Stack(stack.layers, METAL), solved, rows, quality, threads))
    nothing = Medium(albedo=[0.5] * stack.channels, tau=0.0)
    bare = _reflected([solve_with_mirrors(Stack([nothing], METAL), quality, threads)])[0]
    step(0.9, "Solving the stack on metal")

    # Weights for a Lambert surface, for a metal, and their geometric mean
    diffuse, back = base.slices.albedo[0], base.thrown_back[0]
    mirrored = black.albedo[0] + black.direct[0]
    known = channel(METAL.facing, 0)  # its color, which the artist sees; the mean over a uniform sky is .878
    through = np.maximum(metal - mirrored[rows], 0.0) / bare * (1.0 - known * back[rows])
    lit = diffuse[rows] > 1e-6
    ratio = np.where(lit, through / np.where(lit, diffuse[rows], 1.0), 1.0)
    ratio = np.sqrt(np.clip(ratio, 1.0 / MOST, MOST))
    every = np.arange(len(diffuse))
    flat = ratio.reshape(len(rows), -1)
    between = np.stack([np.interp(every, rows, values) for values in flat.T], axis=1).reshape(diffuse.shape)
    weight = np.minimum(diffuse * between, 1.0)

    def shown(row, reflectance, told):
        """Energy over a base with these directional albedos, [channel]."""
        factor = _luminance(weight[row] / (1.0 - told * back[row]))
        return _mean(mirrored[row] + factor * reflectance)

    errors: dict[str, list[float]] = {"lambert": [], "metal": [], "unknown": [], "color": []}
    for number, row in enumerate(rows):
        for rho in REFLECTANCES:
            exact = _mean(mirrored[row] + rho * diffuse[row] / (1.0 - rho * back[row]))
            found = shown(row, rho, rho)
            errors["lambert"].append(_error(_luminance(found), _luminance(exact)))
            errors["color"].append(_error(found, exact))
            errors["unknown"].append(_error(_luminance(shown(row, rho, UNKNOWN)), _luminance(exact)))
        exact, found = _mean(metal[number]), shown(row, bare, known)
        errors["metal"].append(_error(_luminance(found), _luminance(exact)))
        errors["color"].append(_error(found, exact))
        errors["unknown"].append(_error(_luminance(shown(row, bare, UNKNOWN)), _luminance(exact)))

    assert isinstance(stack.base, ShaderBase)
    # The error of the fit over black, relative to the whole light over a base of the stack's reflectance
    gain = base.gain([channel(stack.base.reflectance, c) for c in range(stack.channels)])
    own_norm, whole = norms(black.values, grid), norms(black.values + gain[..., None] * base.slices.values, grid)
    parts = {
        "reflection": replace(dark, errors=relative(np.nan_to_num(dark.errors) * own_norm, whole)),
        "base weight": Mixture([BASE_WEIGHT], weight[None, None]),
        "thrown back": Mixture([THROWN_BACK], base.thrown_back[:, None]),
    }
    return parts, {name: max(found) for name, found in errors.items()}


def _thicknesses(stack: Stack, solved: SolvedRows, rows: list[int], quality: str, threads: int):
    """The scattering functions of `stack` at these of the solved rows."""
    full = solve_with_mirrors(stack, quality, threads)
    if stack.varying is None:
        return [full]
    taus = [stack.optics(stack.varying, c)[1] for c in range(stack.channels)]
    shares = solved.shares
    return [full.with_thickness(stack.varying, [shares[row] * tau for tau in taus]) for row in rows]


def _reflected(functions) -> np.ndarray:
    """Directional albedos, mirrored light included, [function, channel, column]."""
    return np.stack([function.reflectance(view_cosines()).T for function in functions])


def _mean(albedo: np.ndarray) -> np.ndarray:
    """The mean over views of light under a uniform sky; a view at angle theta has the weight sin 2 theta."""
    weights = np.sin(2.0 * column_angles())
    return (albedo * weights).sum(axis=-1) / weights.sum()


def _luminance(values: np.ndarray) -> np.ndarray:
    """Values with the channels along the first axis as one channel."""
    return values if len(values) == 1 else np.tensordot(LUMINANCE, values, 1)[None]


def _error(found: np.ndarray, exact: np.ndarray) -> float:
    return float(np.abs(found / exact - 1.0).max())

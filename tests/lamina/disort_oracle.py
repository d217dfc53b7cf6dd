# SPDX-License-Identifier: GPL-3.0-or-later
"""Two independent solvers with Lamina's conventions: PythonicDISORT and CDISORT (through nanodisort).

Media are (albedo, tau, phase); a stack is a list of them, top first, on a Lambert surface or none.
"""

from __future__ import annotations

from dataclasses import dataclass

import nanodisort
import numpy as np
from PythonicDISORT import pydisort

import lamina


def moments(phase, count: int) -> np.ndarray:
    """Legendre moments chi_0 ... of a phase function, chi_0 = 1."""
    chi = np.zeros(count)
    chi[0] = 1.0
    if isinstance(phase, lamina.HenyeyGreenstein):
        chi = float(phase.g) ** np.arange(count)
    elif isinstance(phase, lamina.Rayleigh):
        chi[2] = 0.1
    return chi


def stack(media, reflectance=None) -> lamina.Stack:
    """The same stack for Lamina."""
    layers = [lamina.Medium(albedo=albedo, tau=tau, phase=phase) for albedo, tau, phase in media]
    return lamina.Stack(layers, None if reflectance is None else lamina.Lambert(reflectance))


@dataclass(frozen=True)
class Answer:
    """Fluxes relative to the incident one, and radiance at the solver's own directions: `brdf` and `btdf` are
    functions of dphi that return one value for each of `mu`."""

    reflectance: float
    diffuse: float
    direct: float
    mu: np.ndarray
    brdf: object
    btdf: object


def pythonic(media, mu0: float, reflectance=None, streams: int = 64, moment_count: int = 400) -> Answer:
    """PythonicDISORT with delta-M and the Nakajima-Tanaka corrections; a beam of unit irradiance on the
    layer. Needs albedos below 1."""
    albedo = np.array([medium[0] for medium in media])
    depth = np.cumsum([medium[1] for medium in media])
    chi = np.array([moments(medium[2], max(moment_count, streams + 1)) for medium in media])
    lower = {} if reflectance is None else {"BDRF_Fourier_modes": [reflectance]}
    mu, up, down, _, radiance = pydisort(depth, albedo, streams, chi, mu0, 1.0 / mu0, 0.0, NLeg=streams,
                                         f_arr=chi[:, streams], NT_cor=True, NFourier=min(streams, 64),
                                         **lower)
    # Nodes are downwelling (negative) or upwelling (positive); the azimuth is that of travel, as in Lamina.
    above, below = mu > 0.0, mu < 0.0
    order_above, order_below = np.argsort(mu[above]), np.argsort(-mu[below])
    diffuse, direct = down(depth[-1])
    return Answer(
        float(up(0.0)), float(diffuse), float(direct), np.sort(mu[above]),
        lambda dphi: radiance(0.0, dphi)[above][order_above],
        lambda dphi: radiance(depth[-1], dphi)[below][order_below],
    )


def cdisort(media, mu0: float, mu, dphi, streams: int = 64, reflectance=0.0, moment_count: int = 400):
    """(reflectance, diffuse transmittance, BRDF [mu, dphi], BTDF [mu, dphi]) by CDISORT."""
    state = nanodisort.DisortState()
    state.nstr, state.nlyr, state.nmom = streams, len(media), moment_count
    state.ntau, state.numu, state.nphi = 2, 2 * len(mu), len(dphi)
    state.usrtau = state.usrang = state.lamber = True
    state.planck = state.onlyfl = False
    state.quiet = True
    state.intensity_correction = state.old_intensity_correction = True
    state.accur = 0.0
    state.allocate()
    state.fbeam, state.umu0, state.phi0 = 1.0 / mu0, mu0, 0.0
    state.albedo = 0.0 if reflectance is None else reflectance
    state.dtauc = np.array([medium[1] for medium in media])
    state.ssalb = np.array([medium[0] for medium in media])
    state.pmom = np.array([moments(medium[2], moment_count + 1) for medium in media]).T
    state.utau = np.array([0.0, sum(medium[1] for medium in media)])
    state.umu = np.concatenate([-np.asarray(mu)[::-1], mu])
    state.phi = np.degrees(dphi)
    state.solve()
    radiance = np.asarray(state.uu)  # [direction, level, azimuth], directions ascending from straight down
    count = len(mu)
    return state.flup[0], state.rfldn[1], radiance[count:, 0], radiance[:count, 1][::-1]

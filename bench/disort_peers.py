# SPDX-License-Identifier: GPL-3.0-or-later
"""The same slab in two discrete-ordinate codes that are independent of Lamina: CDISORT (nanodisort) and PythonicDISORT.
Each function returns (R, T): BRDF and diffuse BTDF, [mu_o, mu_i, dphi]."""

import nanodisort
import numpy as np
from PythonicDISORT import pydisort

MOMENTS = 400


def cdisort(albedo, tau, g, streams, mu_o, mu_i, dphi):
    """One CDISORT solve for each incidence, with CDISORT's single-scattering correction (Nakajima and Tanaka)."""
    state = nanodisort.DisortState()
    state.nstr, state.nlyr, state.nmom, state.ntau = streams, 1, MOMENTS, 2
    state.numu, state.nphi, state.nphase = 2 * len(mu_o), len(dphi), 200
    state.allocate()
    state.usrtau = state.usrang = state.lamber = state.quiet = True
    state.intensity_correction = state.old_intensity_correction = True
    state.dtauc, state.ssalb = np.array([tau]), np.array([albedo])
    state.pmom = (g ** np.arange(MOMENTS + 1)).reshape(-1, 1)
    state.utau, state.phi = np.array([0.0, tau]), np.degrees(dphi)
    order = np.argsort(mu_o)
    state.umu = np.concatenate([-mu_o[order][::-1], mu_o[order]])
    state.fbeam, state.phi0, state.fisot, state.albedo = 1.0, 0.0, 0.0, 0.0
    reflected = np.empty((len(mu_o), len(mu_i), len(dphi)))
    transmitted = np.empty_like(reflected)
    for column, cosine in enumerate(mu_i):
        state.umu0 = cosine
        state.solve()
        radiance = np.asarray(state.uu)
        reflected[order, column] = radiance[len(mu_o):, 0] / cosine
        transmitted[order, column] = radiance[:len(mu_o), 1][::-1] / cosine
    return reflected, transmitted


def pythonic_disort(albedo, tau, g, streams, mu_o, mu_i, dphi):
    """One PythonicDISORT solve for each incidence; values at its own nodes, interpolated to mu_o."""
    moments = g ** np.arange(MOMENTS)
    share = g**streams
    reflected = np.empty((len(mu_o), len(mu_i), len(dphi)))
    transmitted = np.empty_like(reflected)
    for column, cosine in enumerate(mu_i):
        nodes, _, _, _, radiance = pydisort(
            np.array([tau]), np.array([albedo]), streams, moments[None, :], cosine, 1.0, 0.0,
            NLeg=streams, NFourier=streams, f_arr=np.array([share]), NT_cor=True,
        )
        half = streams // 2
        top, bottom = radiance(0.0, dphi)[:half], radiance(tau, dphi)[half:]
        carry = barycentric(nodes[:half], mu_o)
        reflected[:, column] = carry @ top / cosine
        transmitted[:, column] = carry @ bottom / cosine
    return reflected, transmitted


def barycentric(nodes, points):
    """Matrix of polynomial interpolation from nodes to points."""
    differences = 4.0 * (nodes[:, None] - nodes[None, :]) + np.eye(len(nodes))
    weights = 1.0 / differences.prod(axis=1)
    terms = weights / (points[:, None] - nodes[None, :] + 1e-15)
    return terms / terms.sum(axis=1, keepdims=True)

# SPDX-License-Identifier: GPL-3.0-or-later
"""A scattering function as an xarray.Dataset: arrays with named axes and units."""

from __future__ import annotations

import numpy as np

from ..common.arguments import finite_list
from ..common.extras import require

COSINES = np.linspace(0.05, 1.0, 20)
AZIMUTHS = np.linspace(0.0, np.pi, 13)
CHANNELS = ("red", "green", "blue")
COSINE = {"units": "1", "long_name": "cosine with the normal"}


def channel_names(count: int) -> list:
    """Names of the channels: colours for three, else numbers."""
    return list(CHANNELS) if count == 3 else list(range(count))


def dataset(function, mu_o=None, mu_i=None, dphi=None):
    """See ScatteringFunction.to_xarray."""
    xarray = require("xarray", "to_xarray")
    axes = [finite_list(usual if given is None else given, name)
            for name, given, usual in (("mu_o", mu_o, COSINES), ("mu_i", mu_i, COSINES), ("dphi", dphi, AZIMUTHS))]
    stack = function.stack
    sides = ["top", "bottom"] if stack.base is None else ["top"]
    names = ("side", "mu_o", "mu_i", "dphi", "channel")

    def everywhere(path):
        return np.stack([function.grid(path, *axes, side=side) for side in sides])

    def fluxes(call):
        return np.stack([call(axes[1], side=side) for side in sides])

    flux = ("side", "mu_i", "channel")
    found = {"brdf": (names, everywhere("reflect"), {"units": "1/sr", "long_name": "BRDF without specular parts"}),
             "reflectance": (flux, fluxes(function.reflectance), {
                 "units": "1", "long_name": "hemispherical reflectance, specular reflection included"})}
    if stack.base is None:
        found["btdf"] = (names, everywhere("transmit"), {
            "units": "1/sr", "long_name": "BTDF without unscattered light; light enters on the side"})
        found["transmittance"] = (flux, fluxes(function.transmittance), {
            "units": "1", "long_name": "hemispherical transmittance, unscattered light included"})
    coordinates = {
        "side": ("side", sides, {"long_name": "side on which light enters"}),
        "mu_o": ("mu_o", axes[0], {**COSINE, "long_name": "cosine of the outgoing direction with the normal"}),
        "mu_i": ("mu_i", axes[1], {**COSINE, "long_name": "cosine of the incoming direction with the normal"}),
        "dphi": ("dphi", axes[2], {"units": "rad", "long_name": "azimuth; 0: light keeps its azimuth"}),
        "channel": ("channel", channel_names(stack.channels)),
    }
    if stack.wavelengths is not None:
        coordinates["channel"] = ("channel", list(stack.wavelengths), {"units": "nm", "long_name": "wavelength"})
    attributes = {"stack": stack.label, "stack_hash": stack.hash, "nodes": function.nodes, "orders": function.orders}
    return xarray.Dataset(found, coordinates, attributes)

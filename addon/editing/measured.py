# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured material as the base of a material's layers."""

import warnings

from ..base import native
from ..kinds.bases import Measured


def read(material, path):
    """Make the base of `material` the measured one in this file of MERL or RGL, with its whole table. Returns
    what Lamina warns of, or ''. Raises lamina.MeasurementError, OSError, NativeMissingError; then nothing is
    changed."""
    load = native.part("measurements").load_base
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UserWarning)
        found = load(path)
    base = material.lamina.base
    base.table, base.measured_name = found.table, found.name
    base.kind = Measured.kind
    return " ".join(str(one.message) for one in told)

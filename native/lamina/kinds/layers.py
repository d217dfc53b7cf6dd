# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers other than media and interfaces: their fields, forms and options describe them wholly."""

from __future__ import annotations

from .fibers import Fibers
from .films import Film
from .flakes import Flakes

OrientedLayer = Flakes | Fibers  # small surfaces, oriented about the layer's normal
DESCRIBED = {cls.kind: cls for cls in (Film, Flakes, Fibers)}

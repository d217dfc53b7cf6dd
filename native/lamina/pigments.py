# SPDX-License-Identifier: GPL-3.0-or-later
"""Pigments by name."""

from .material.pigments import absorption, amount_of, names, source

__all__ = ["absorption", "amount_of", "names", "source"]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits that lamina and the add-on share: the schema of a stack's JSON, and ranges of arguments."""

from __future__ import annotations

STACK_SCHEMA = 1

MOST_THREADS = 1024
THREADS = f"must be a whole number from 0 (all) to {MOST_THREADS}"
MOST_SEED = (1 << 64) - 1
SEED = "must be a whole number from 0 to 2^64 - 1"
MOST_TEXELS = 16384  # width and height of an image
MOST_NODE_IOR = 3.8  # of Cycles' Subsurface Scattering node

# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranges of the arguments that several commands share."""

from __future__ import annotations

MOST_THREADS = 1024
THREADS = f"must be a whole number from 0 (all) to {MOST_THREADS}"
MOST_SEED = (1 << 64) - 1
SEED = "must be a whole number from 0 to 2^64 - 1"

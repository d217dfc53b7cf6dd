# SPDX-License-Identifier: GPL-3.0-or-later
"""How good a lookup table is, in numbers, words and pictures."""

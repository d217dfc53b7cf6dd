# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures fitted to the light of a stack, and their sum."""

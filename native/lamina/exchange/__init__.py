# SPDX-License-Identifier: GPL-3.0-or-later
"""Solved scattering functions as files for other programs."""

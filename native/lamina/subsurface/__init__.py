# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' random walk below a surface: what its node makes of a colour and a radius, and the inputs for a stack."""

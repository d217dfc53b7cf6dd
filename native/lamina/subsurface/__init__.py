# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' subsurface random walk: the response of its node to colour and radius, and the inputs for a stack."""

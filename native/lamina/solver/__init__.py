# SPDX-License-Identifier: GPL-3.0-or-later
"""The deterministic solver: a stack in, its scattering function out."""

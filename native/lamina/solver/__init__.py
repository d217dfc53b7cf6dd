# SPDX-License-Identifier: GPL-3.0-or-later
"""The deterministic solver: from a stack to its scattering function."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""Monte Carlo estimates of a stack's scattering function, in one process or in shards."""

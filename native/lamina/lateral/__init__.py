# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that travels sideways: the response of a stack with lengths to a pencil beam, by deterministic methods."""

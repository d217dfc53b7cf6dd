# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that travels sideways, deterministic: what a stack with lengths makes of a pencil beam."""

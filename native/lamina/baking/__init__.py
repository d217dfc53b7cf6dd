# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: from a stack to a lookup table of closure weights, and what the table's report tells."""

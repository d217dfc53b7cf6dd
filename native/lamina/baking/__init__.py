# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: from a stack to a lookup table of closure weights with a report on its accuracy."""

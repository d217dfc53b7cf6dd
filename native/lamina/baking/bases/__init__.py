# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake does for each kind of base."""

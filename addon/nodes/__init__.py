# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group that a bake makes, and what feeds its thickness input."""

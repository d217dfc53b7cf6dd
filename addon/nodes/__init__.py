# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group of a baked material, and the nodes that feed its thickness input."""

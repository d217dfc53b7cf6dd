# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials and objects keep in the .blend."""
